// Describes command-line errors for which CLI11 has no message, or only an unhelpful message.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// Returns the innermost verb on the command line, or the program if there is no verb.
CLI::App& chosen_verb(CLI::App& program);
// Returns a sentence about words that the parser could not use: "there is no verb `dmo`; did you mean demo?".
// Empty: there are no such words.
std::string unknown_words(CLI::App& program);
// Returns a sentence about an option with an empty value. Empty: no option of the chosen verb has an empty
// value.
std::string empty_value(CLI::App& program);
// Returns the sentence for `error`, which the last call of program.parse() threw.
std::string wrong_usage(CLI::App& program, const CLI::ParseError& error);

}  // namespace kaz::tools
