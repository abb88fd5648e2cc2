// What is wrong with a command line, in one sentence: what, where, what to give instead.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/wrong_usage.h"

#include <algorithm>
#include <cctype>
#include <ranges>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/app/base/suggestion.h"
#include "tools/kaz/help.h"
#include "tools/kaz/values.h"

namespace kaz::tools {
namespace {

// The program, its verb, the verb's verb: as far as they were given.
std::vector<CLI::App*> given_verbs(CLI::App& program) {
  std::vector<CLI::App*> chain{&program};
  while (!chain.back()->get_subcommands().empty())
    chain.push_back(chain.back()->get_subcommands().front());
  return chain;
}

std::vector<std::string> verb_names(CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands(nullptr)) names.push_back(verb->get_name());
  return names;
}

// CLI11 gives none of an option that help does not show.
std::string name_of(const CLI::Option& option) {
  const std::string name = option.get_name();
  return name.empty() && !option.get_lnames().empty() ? "--" + option.get_lnames().front() : name;
}

std::vector<CLI::Option*> positionals(CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word != "--" &&
         !std::isdigit(static_cast<unsigned char>(word[1]));
}

std::string unknown_option(CLI::App& program) {
  CLI::App& verb = chosen_verb(program);
  for (const CLI::App* app : given_verbs(program)) {
    for (const std::string& word : app->remaining()) {
      if (!is_option(word)) continue;
      const std::string name = word.substr(0, word.find('='));
      std::vector<std::string> names;
      for (const CLI::Option* option : verb.get_options()) {
        for (const std::string& known : option->get_lnames()) names.push_back("--" + known);
      }
      if (std::ranges::count(names, name) > 0)  // `app` is above `verb`
        return "give " + name + " after the verb " + verb.get_name();
      return "there is no option " + name + suggestion(name, names);
    }
  }
  return "";
}

std::string unexpected_words(CLI::App& program) {
  for (CLI::App* app : given_verbs(program)) {
    const auto words = app->remaining();
    if (words.empty()) continue;
    const std::string text = "unexpected: `" + CLI::detail::join(words, " ") + "`";
    // A verb that was mistyped may have been taken for another argument.
    for (const CLI::Option* positional : positionals(*app)) {
      for (const std::string& word : positional->results()) {
        const std::string verb = suggestion(word, verb_names(*app));
        if (!verb.empty()) return text + verb;
      }
    }
    return text;
  }
  return "";
}

// The option that a message of CLI11 is about.
CLI::Option* option_of(CLI::App& program, const std::string& message) {
  auto chain = given_verbs(program);
  for (CLI::App* app : chain | std::views::reverse) {
    for (CLI::Option* option : app->get_options()) {
      const std::string name = name_of(*option);
      if (message.starts_with(name + ":") || message.starts_with(name + " ") ||
          message.ends_with(" for " + name) || message.find(": " + name + " = ") != message.npos)
        return option;
      if (option->get_name().empty() && message.starts_with(":") &&
          message.find(" " + option->get_type_name() + " ") != message.npos)
        return option;
    }
  }
  return nullptr;
}

bool is_flag(const CLI::Option& option) {
  return option.get_items_expected_max() == 0;
}

CLI::Validator* validator(CLI::Option& option, int index) {
  try {
    return option.get_validator(index);
  } catch (const CLI::OptionNotFound&) {
    return nullptr;
  }
}

// The last value that does not pass, and what its check says. Checks may have rewritten earlier ones.
std::pair<std::string, std::string> refused(CLI::Option& option) {
  const auto values = option.results();
  for (const std::string& value : values | std::views::reverse) {
    const CLI::Validator* check = nullptr;
    for (int i = 0; (check = validator(option, i)) != nullptr; ++i) {
      std::string text = value, why;
      try {
        why = (*check)(text);
      } catch (const CLI::ValidationError&) {  // IsMember of numbers: no number
        why = value;
      }
      if (!why.empty()) return {value, why};
    }
  }
  return {};
}

std::string refused_value(CLI::Option& option, const std::string& message) {
  const auto [value, why] = refused(option);
  const std::string values = accepted(option);
  if (!values.empty()) return name_of(option) + " " + value + ": give " + values;
  return why.starts_with("give ") ? name_of(option) + " " + value + ": " + why : message;
}

std::string wrong_count(const CLI::Option& option) {
  static constexpr const char* kNumbers[] = {"no", "a", "two", "three", "four"};
  const int min = option.get_items_expected_min();
  const auto given = option.results().size();
  if (min == 1 && given > 1)
    return name_of(option) + " is given " + std::to_string(given) + " times" +
           (option.get_positional() ? ", as an option or as an argument" : "") + "; give " +
           name_of(option) + " once";
  const std::string count =
      min >= 0 && min < 5 ? kNumbers[min] : std::to_string(min);  // verbs have at most two
  return name_of(option) + ": give " + count + " value" + (min == 1 ? "" : "s") + ", as in " +
         typed_form(option);
}

std::string missing(CLI::App& program, const CLI::Option* option) {
  if (option == nullptr) {
    const auto names = verb_names(chosen_verb(program));
    constexpr std::size_t kMaxListed = 8;
    return "the verb is missing" +
           (names.size() > kMaxListed ? "" : ": give " + alternatives(names));
  }
  const std::string name = name_of(*option);
  return option->nonpositional() ? name + " is missing; give " + typed_form(*option)
                                 : name + " is missing: " + option->get_description();
}

}  // namespace

void check_flags(CLI::App& app) {
  const CLI::Validator truth(
      [](std::string& value) {
        for (const char* known : {"true", "false", "1", "0"})
          if (value == known) return std::string();
        return std::string("takes no value");
      },
      "");
  for (CLI::Option* option : app.get_options()) {
    if (!is_flag(*option) || option->get_lnames().empty()) continue;
    // Others stand for a text, such as a file's name.
    const std::string given = option->get_flag_value(option->get_lnames().front(), "{}");
    if (given == "true" || given == "false") option->check(truth);
  }
  for (CLI::App* verb : app.get_subcommands(nullptr)) check_flags(*verb);
}

CLI::App& chosen_verb(CLI::App& program) {
  return *given_verbs(program).back();
}

std::string unknown_verb(CLI::App& program) {
  CLI::App& app = chosen_verb(program);
  const auto words = app.remaining();
  const auto names = verb_names(app);
  if (words.empty() || is_option(words.front()) || names.empty() || !positionals(app).empty())
    return "";
  return "there is no verb `" + words.front() + "`" + suggestion(words.front(), names);
}

std::string empty_value(CLI::App& program) {
  for (const CLI::Option* option : chosen_verb(program).get_options()) {
    if (option->get_items_expected_min() == 0) continue;  // its value may be left out
    if (std::ranges::count(option->results(), "") > 0)
      return name_of(*option) + " is empty; give " + typed_form(*option);
  }
  return "";
}

std::string wrong_usage(CLI::App& program, const CLI::ParseError& error) {
  // First what was not understood: CLI11 may instead have reported what is missing because of it.
  for (const auto find : {unknown_verb, unknown_option}) {
    if (const std::string text = find(program); !text.empty()) return text;
  }
  const std::string kind = error.get_name(), message = error.what();
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError))
    return unexpected_words(program);
  CLI::Option* option = option_of(program, message);
  if (kind == "RequiredError") return missing(program, option);
  if (option == nullptr) return message;
  const std::string name = name_of(*option);
  const std::string other = message.substr(message.rfind(' ') + 1);
  if (kind == "RequiresError") return name + " needs " + other;
  if (kind == "ExcludesError") return "give " + name + " or " + other + ", not both";
  if (is_flag(*option)) return name + " takes no value";
  if (kind == "ValidationError") return refused_value(*option, message);
  if (kind == "ArgumentMismatch") return wrong_count(*option);
  if (kind == "ConversionError")
    return name + " " + CLI::detail::join(option->results(), " ") + ": give a number";
  return message;
}

}  // namespace kaz::tools
