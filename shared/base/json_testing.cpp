// SPDX-License-Identifier: Apache-2.0
#include "shared/base/json_testing.h"

#include <nlohmann/json.hpp>
#include <ostream>

namespace kaz {

nlohmann::json parse_json(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, false);
}

}  // namespace kaz

namespace nlohmann {

void PrintTo(const json& value, std::ostream* out) {
  *out << value;
}

}  // namespace nlohmann
