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
  // "keep|straight|home"; empty: the value is a number in [min, max]. With is_valid: describes the form,
  // for messages.
  std::string_view choices = {};
  double min = 0, max = 0;
  std::string_view text = {};  // description, one line, with the unit
  // Only numbers without a fraction are valid.
  bool whole = false;
  // If set, the value is a text, and this returns whether it is valid.
  bool (*is_valid)(std::string_view value) = nullptr;
};

// Returns the valid values, for messages: "keep|straight|home", "1 to 20".
std::string valid_values(const Option& option);

class OptionValues {
 public:
  // Returns the defaults overridden by `given`. Errors (usage): an unknown name, or a value that is no
  // number, not whole where it must be, or outside its range or choices. The message lists the valid ones.
  static Result<OptionValues> parse(std::span<const Option> options,
                                    const std::map<std::string, std::string>& given);

  // Precondition: `name` is one of the parsed options and has this type. Otherwise they throw
  // std::out_of_range with a message.
  double number(std::string_view name) const;
  // Value of a choice or of a text.
  const std::string& choice(std::string_view name) const;

 private:
  std::map<std::string, double, std::less<>> numbers_;
  std::map<std::string, std::string, std::less<>> choices_;
};

}  // namespace kaz::behavior
