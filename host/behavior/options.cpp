// Validates option values; errors list the valid names and values.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "shared/base/number_text.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::behavior {

namespace {

std::string known_names(std::span<const Option> options) {
  std::string names;
  for (const Option& option : options) {
    names += (names.empty() ? "" : ", ") + std::string(option.name);
  }
  return names.empty() ? "it has no options" : "its options are " + names;
}

bool is_choice(std::string_view choices, std::string_view value) {
  while (!value.empty()) {
    const auto end = choices.find('|');
    if (choices.substr(0, end) == value) return true;
    if (end == std::string_view::npos) return false;
    choices.remove_prefix(end + 1);
  }
  return false;
}

std::string short_number(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

std::out_of_range no_option(std::string_view name, const char* kind) {
  return std::out_of_range("the behavior has no option `" + std::string(name) + "` that is a " +
                           kind);
}

// Start of the error for a wrong value.
std::string not_a_value(const std::string& text, const std::string& option) {
  std::string start = "`";
  start.append(shown_text(text)).append("` is not a value of the option `");
  return start.append(option).append("`: must be ");
}

}  // namespace

std::string valid_values(const Option& option) {
  if (!option.choices.empty()) return std::string(option.choices);
  return short_number(option.min) + " to " + short_number(option.max);
}

Result<OptionValues> OptionValues::parse(std::span<const Option> options,
                                         const std::map<std::string, std::string>& given) {
  for (const auto& [name, value] : given) {
    const bool known = std::any_of(options.begin(), options.end(),
                                   [&, &key = name](const Option& o) { return o.name == key; });
    if (!known) {
      return fail(Fault::usage,
                  "the behavior has no option `" + shown_text(name) + "`: " + known_names(options));
    }
  }

  OptionValues values;
  for (const Option& option : options) {
    const std::string name(option.name);
    const auto found = given.find(name);
    const std::string text = found == given.end() ? std::string(option.initial) : found->second;
    if (!option.choices.empty()) {
      const bool text_option = option.is_valid != nullptr;
      if (text_option ? !option.is_valid(text) : !is_choice(option.choices, text)) {
        std::string wrong = not_a_value(text, name) + (text_option ? "" : "one of ");
        wrong.append(option.choices);
        if (text_option) wrong.append(" (").append(option.text).append(")");
        return fail(Fault::usage, wrong);
      }
      values.choices_[name] = text;
      continue;
    }
    const auto number = parse_number<double>(text);
    if (!number || *number < option.min || *number > option.max ||
        (option.whole && *number != std::floor(*number))) {
      return fail(Fault::usage, not_a_value(text, name) + "a " +
                                    (option.whole ? "whole number" : "number") + " from " +
                                    valid_values(option) + " (" + std::string(option.text) + ")");
    }
    values.numbers_[name] = *number;
  }
  return values;
}

double OptionValues::number(std::string_view name) const {
  const auto found = numbers_.find(name);
  if (found == numbers_.end()) throw no_option(name, "number");
  return found->second;
}

const std::string& OptionValues::choice(std::string_view name) const {
  const auto found = choices_.find(name);
  if (found == choices_.end()) throw no_option(name, "choice");
  return found->second;
}

}  // namespace kaz::behavior
