// Describes the values that an option accepts in words, instead of CLI11's notation of types and checks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// Returns the placeholder for the value: "N", "FILE", "h8|native". Empty: none.
std::string placeholder(const CLI::Option& option);
// Returns the valid values, {"h8", "native"}. Empty: other values may be valid.
std::vector<std::string> choices(const CLI::Option& option);
// Returns the range, "1 to 20 V" or "0 to 0x1ffff". Empty: no bounds.
std::string range(const CLI::Option& option);
// Returns choices or range for messages: "h8 or native", "a whole number from 1 to 14", "1 to 20 V". Empty if
// both are.
std::string accepted(const CLI::Option& option);
// Returns the default value: "18432000", not "1.8432e+07"; "red,green", not "[red,green]".
std::string default_text(const CLI::Option& option);
// Joins words: "a, b or c".
std::string alternatives(const std::vector<std::string>& words);

}  // namespace kaz::tools
