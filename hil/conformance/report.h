// Reports of a run of the suite: JUnit XML, JSON, one HTML page.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/conformance/suite.h"
#include "hil/report/provenance.h"

namespace kaz::hil {

struct ReportFacts {
  std::string port;     // name of the port, such as "/dev/ttyUSB0" or "virtual board (h8)"
  std::string program;  // program and version, such as "kaz 0.1.0"
  std::uint64_t seed = 1;
  std::string signal = {};      // signal that interrupted the run, such as "SIGINT"; may be empty
  std::string broken_off = {};  // reason why the run could not finish; empty: the run finished
  Provenance from = {};
};

std::string junit_text(const RunReport& report, const ReportFacts& facts);
std::string json_text(const RunReport& report, const ReportFacts& facts);
// Returns a self-contained page, which has no script and fetches nothing.
std::string html_text(const RunReport& report, const ReportFacts& facts);

}  // namespace kaz::hil
