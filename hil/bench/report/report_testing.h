// For tests: a report with everything that a report can hold.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tinyxml2.h>

#include "hil/bench/report.h"

namespace kaz::hil {

// Passed, failed and left out; limits on both sides, one and none; NaN and infinite; text that
// needs quoting; plots of all styles.
BenchReport test_report();

// Parses `xml` as XML; fails the test if it is none.
void parse_xml(const std::string& xml, tinyxml2::XMLDocument& to);
// Elements of this name, anywhere below.
std::vector<const tinyxml2::XMLElement*> elements(const tinyxml2::XMLNode& below,
                                                  const std::string& name);

}  // namespace kaz::hil
