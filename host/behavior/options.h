// Options of a behavior: named numbers, choices and texts, with defaults.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include "shared/base/result.hpp"

namespace kaz::behavior {

struct Option {
  std::string_view name;     // "seconds"
  std::string_view initial;  // default value
  // Valid choices: "keep|straight|home". Empty: the value is a number in [min, max]. If is_valid is set:
  // description of a valid text, for messages.
  std::string_view choices = {};
  double min = 0, max = 0;
  std::string_view text = {};  // description, one line, with the unit
  // Only numbers without a fraction are valid.
  bool whole = false;
  // If set, the value is a text. Returns whether `value` is valid.
  bool (*is_valid)(std::string_view value) = nullptr;
};

// Returns the valid values, for messages: "keep|straight|home", "1 to 20".
std::string valid_values(const Option& option);

class OptionValues {
 public:
  // Returns the defaults overridden by `given`. Errors (usage): a name is unknown, or a value is not valid
  // for its option. The message lists the valid names or values.
  static Result<OptionValues> parse(std::span<const Option> options,
                                    const std::map<std::string, std::string>& given);

  // Value of a number. Precondition for number() and choice(): `name` is a parsed option of that type.
  // Otherwise both throw std::out_of_range with a message.
  double number(std::string_view name) const;
  // Value of a choice or of a text.
  const std::string& choice(std::string_view name) const;

 private:
  std::map<std::string, double, std::less<>> numbers_;
  std::map<std::string, std::string, std::less<>> choices_;
};

}  // namespace kaz::behavior
