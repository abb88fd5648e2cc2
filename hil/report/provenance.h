// Where a report comes from: when, by which program, on which machine, by which command.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace kaz::hil {

struct Provenance {
  std::string date;  // UTC, ISO 8601: "2026-11-23T08:13:16Z"
  std::string kaz;   // version
  std::string cpu, os;
  int cores = 0;        // that the program may use
  std::string command;  // "kaz bench motor --out motor"
};

// The object `provenance` of every report in JSON.
nlohmann::ordered_json provenance_json(const Provenance& from);
// Names and values, for properties of JUnit XML. Empty without a date: of a report made in a test.
std::vector<std::pair<std::string, std::string>> provenance_properties(const Provenance& from);
// A part of a page's facts, from <br> on; empty without a date.
std::string provenance_html(const Provenance& from);

}  // namespace kaz::hil
