// JSON for tests. Parsing and printing are compiled only once, because compiling both takes 2 s per test.
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace kaz {

// Parses `text`. For invalid JSON, is_discarded() of the result is true.
nlohmann::json parse_json(std::string_view text);

}  // namespace kaz

namespace nlohmann {

// GoogleTest calls this function to print a JSON value in a failure message.
void PrintTo(const json& value, std::ostream* out);

}  // namespace nlohmann
