// JSON in tests: reading and printing it are compiled once, not in each test, where they take 2 s.
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace kaz {

// The value that `text` stands for; where it is not JSON, one whose is_discarded() is true.
nlohmann::json parse_json(std::string_view text);

}  // namespace kaz

namespace nlohmann {

// Called by GoogleTest for a value that is not the expected one.
void PrintTo(const json& value, std::ostream* out);

}  // namespace nlohmann
