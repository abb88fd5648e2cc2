// A run of the suite for machines and people: JUnit XML, JSON, one HTML page.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/conformance/suite.h"

namespace kaz::hil {

struct ReportFacts {
  std::string port;     // "/dev/ttyUSB0", "virtual board (h8)"
  std::string program;  // "kaz 0.1.0"
  std::uint64_t seed = 1;
  std::string signal = {};      // that interrupted the run: "SIGINT"; empty: none
  std::string broken_off = {};  // why the machine did not let it come to its end; empty: it did
};

std::string junit_text(const RunReport& report, const ReportFacts& facts);
std::string json_text(const RunReport& report, const ReportFacts& facts);
// Self-contained: no script, nothing fetched.
std::string html_text(const RunReport& report, const ReportFacts& facts);

}  // namespace kaz::hil
