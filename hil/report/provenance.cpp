// Where a report comes from, in each format of reports.
// SPDX-License-Identifier: Apache-2.0
#include "hil/report/provenance.h"

#include <nlohmann/json.hpp>

#include "shared/base/one_line.hpp"
#include "shared/base/xml_text.hpp"

namespace kaz::hil {

nlohmann::ordered_json provenance_json(const Provenance& from) {
  return {
      {"date", from.date},
      {"kaz", from.kaz},
      {"machine", {{"cpu", one_line(from.cpu)}, {"cores", from.cores}, {"os", one_line(from.os)}}},
      {"command", one_line(from.command)}};
}

std::vector<std::pair<std::string, std::string>> provenance_properties(const Provenance& from) {
  if (from.date.empty()) return {};
  return {{"date", from.date},         {"kaz", from.kaz},
          {"cpu", one_line(from.cpu)}, {"cores", std::to_string(from.cores)},
          {"os", one_line(from.os)},   {"command", one_line(from.command)}};
}

std::string provenance_html(const Provenance& from) {
  if (from.date.empty()) return "";
  return "<br>" + xml_text(from.date) + ", " + xml_text(one_line(from.cpu)) + ", " +
         std::to_string(from.cores) + " cores, " + xml_text(one_line(from.os)) + "<br><code>" +
         xml_text(one_line(from.command)) + "</code>";
}

}  // namespace kaz::hil
