// Errors in the command line for which CLI11 has no text, or a text that does not help.
// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/wrong_usage.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "tools/base/suggestion.h"

namespace kaz::tools {
namespace {

std::vector<std::string> verb_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands(nullptr)) names.push_back(verb->get_name());
  return names;
}

bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word != "--" &&
         !std::isdigit(static_cast<unsigned char>(word[1]));
}

}  // namespace

CLI::App& chosen_verb(CLI::App& program) {
  const auto verbs = program.get_subcommands();
  return verbs.empty() ? program : chosen_verb(*verbs.front());
}

std::string unknown_words(CLI::App& program) {
  const CLI::App& verb = chosen_verb(program);
  const auto words = program.remaining(true);
  if (words.empty()) return "";
  if (verb.get_require_subcommand_min() > 0 && !is_option(words.front()))
    return "there is no verb `" + words.front() + "`" + suggestion(words.front(), verb_names(verb));
  const auto option = std::ranges::find_if(words, is_option);
  if (option == words.end()) return "unexpected: `" + CLI::detail::join(words, " ") + "`";
  const std::string name = option->substr(0, option->find('='));
  std::vector<std::string> known;
  for (const CLI::Option* one : verb.get_options())
    for (const std::string& long_name : one->get_lnames()) known.push_back("--" + long_name);
  if (std::ranges::count(known, name) > 0)
    return "give " + name + " after the verb " + verb.get_name();
  return "there is no option " + name + suggestion(name, known);
}

std::string empty_value(CLI::App& program) {
  for (const CLI::Option* option : chosen_verb(program).get_options()) {
    if (option->get_items_expected_min() == 0) continue;  // its value may be left out
    if (std::ranges::count(option->results(), "") > 0)
      return option->get_name() + ": must not be empty";
  }
  return "";
}

std::string wrong_usage(CLI::App& program, const CLI::ParseError& error) {
  // CLI11 may have reported what is missing because of words that it could not use.
  if (const std::string unknown = unknown_words(program); !unknown.empty()) return unknown;
  const CLI::App& verb = chosen_verb(program);
  if (verb.get_require_subcommand_min() > 0 &&
      dynamic_cast<const CLI::RequiredError*>(&error) != nullptr)
    return "the verb is missing; give one of: " + CLI::detail::join(verb_names(verb), ", ");
  return error.what();
}

}  // namespace kaz::tools
