// What values an option takes, in words instead of CLI11's notation of types and checks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// What stands for the value: "N", "FILE", "h8|native"; empty if nothing does.
std::string placeholder(const CLI::Option& option);
// {"h8", "native"}; empty where any other value may be valid too.
std::vector<std::string> choices(const CLI::Option& option);
// "1 to 20 V", "0 to 0x1ffff"; empty where there are no bounds.
std::string range(const CLI::Option& option);
// For messages: "h8 or native", "a whole number from 1 to 14", "1 to 20 V"; empty where choices() and
// range() are.
std::string accepted(const CLI::Option& option);
// "18432000", not "1.8432e+07"; "red,green", not "[red,green]".
std::string default_text(const CLI::Option& option);
// "a, b or c".
std::string alternatives(const std::vector<std::string>& words);

}  // namespace kaz::tools
