// `kaz conformance`: the protocol certificate of a board, case by case.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/conformance/report.h"
#include "shared/base/result.hpp"

namespace kaz::tools {

struct ConformanceOptions {
  std::string port, mcu, image;   // a board at a port, or a virtual one: "h8" or "native"
  std::string junit, json, html;  // files of reports; "-": standard output, empty: none
  bool list = false, allow_motion = false, allow_flash = false;
  hil::RunOptions run;
};

// Runs the cases and writes the reports, or lists the cases. False: a case failed.
Result<bool> run_conformance(ConformanceOptions arguments);

}  // namespace kaz::tools
