// Describes an error in the command line in one sentence: what is wrong, where, and a correct form.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// Returns the innermost verb on the command line, or the program if there is no verb.
CLI::App& chosen_verb(CLI::App& program);
// Restricts the values of flags to true, false, 1 and 0, for `app` and its verbs. Without this check, CLI11
// accepts any number above 0, and some words, as true.
void check_flags(CLI::App& app);
// Returns a sentence if an unknown word is in the place of a verb: "there is no verb `dmo`; did you mean
// demo?". Empty: there is no unknown word.
std::string unknown_verb(CLI::App& program);
// Returns a sentence about an option with an empty value: "--out is empty; give --out DIR". Empty: no option
// of the chosen verb has an empty value.
std::string empty_value(CLI::App& program);
// Returns the sentence for `error`, which the last call of program.parse() threw.
std::string wrong_usage(CLI::App& program, const CLI::ParseError& error);

}  // namespace kaz::tools
