// Describes the values that an option accepts, in words for users.
// SPDX-License-Identifier: Apache-2.0
// CLI11 would print its own notation of types and checks.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// Returns the placeholder for the value: "N", "FILE", "h8|native". Empty: the option has no placeholder.
std::string placeholder(const CLI::Option& option);
// Returns the valid values: {"h8", "native"}. Empty: the valid values are not a fixed list.
std::vector<std::string> choices(const CLI::Option& option);
// Returns the range: "1 to 20 V" or "0 to 0x1ffff". Empty: the option has no bounds.
std::string range(const CLI::Option& option);
// Returns the choices or the range, in words for messages: "h8 or native", "a whole number from 1 to 14", "1
// to 20 V". Empty if the option has neither choices nor a range.
std::string accepted(const CLI::Option& option);
// Returns the default value as a user would type it: "18432000", not "1.8432e+07"; "red,green", not
// "[red,green]".
std::string default_text(const CLI::Option& option);
// Joins words: "a, b or c".
std::string alternatives(const std::vector<std::string>& words);

}  // namespace kaz::tools
