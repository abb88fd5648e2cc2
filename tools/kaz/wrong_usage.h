// Describes an error of the command line in one sentence: the fault, its place, and a correct form.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// Returns the innermost verb that was given, or the program itself.
CLI::App& chosen_verb(CLI::App& program);
// Restricts values of flags to true, false, 1 and 0, for `app` and its verbs. CLI11 takes any number above 0,
// and words, as true.
void check_flags(CLI::App& app);
// Returns a sentence about a word in place of a verb: "there is no verb `dmo`; did you mean demo?". Empty: no
// such word.
std::string unknown_verb(CLI::App& program);
// Returns a sentence about an empty value: "--out is empty; give --out DIR". Empty: no option of the chosen
// verb has one.
std::string empty_value(CLI::App& program);
// Returns the sentence about the last call of program.parse(), which threw `error`.
std::string wrong_usage(CLI::App& program, const CLI::ParseError& error);

}  // namespace kaz::tools
