// What is wrong with a command line, in one sentence: what, where, what to give instead.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// The verb that was given, as far as there is one: the program itself, or its verb's verb.
CLI::App& chosen_verb(CLI::App& program);
// Lets flags take no value but true, false, 1 and 0, of this verb and its verbs: CLI11 takes any number above
// 0, and words, as true.
void check_flags(CLI::App& app);
// "there is no verb `dmo`; did you mean demo?" about a word in the place of a verb; empty if there is none.
std::string unknown_verb(CLI::App& program);
// "--out is empty; give --out DIR" about an option of the chosen verb; empty if there is none.
std::string empty_value(CLI::App& program);
// About the last call of program.parse(), which threw `error`.
std::string wrong_usage(CLI::App& program, const CLI::ParseError& error);

}  // namespace kaz::tools
