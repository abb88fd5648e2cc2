// Provenance of a report: date, program version, machine and command.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace kaz::hil {

struct Provenance {
  std::string date;  // UTC, ISO 8601: "2026-11-23T08:13:16Z"
  std::string kaz;   // version of the program
  std::string cpu, os;
  int cores = 0;        // number of cores available to the program
  std::string command;  // command line, such as "kaz bench motor --out motor"
};

// Returns the object `provenance` of JSON reports.
nlohmann::ordered_json provenance_json(const Provenance& from);
// Returns names and values for properties of JUnit XML. The result is empty if there is no date; reports of
// tests have no date.
std::vector<std::pair<std::string, std::string>> provenance_properties(const Provenance& from);
// Returns HTML for the facts of a page. The HTML begins with a line break. The result is empty if there is no
// date.
std::string provenance_html(const Provenance& from);

}  // namespace kaz::hil
