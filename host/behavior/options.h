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
  std::string_view name;     // such as "seconds"
  std::string_view initial;  // default value
  // Valid choices, such as "keep|straight|home". If `choices` is empty, the value is a number in [min, max].
  // If is_valid is not null, `choices` must contain a description of the valid texts for error messages.
  std::string_view choices = {};
  double min = 0, max = 0;
  std::string_view text = {};  // description of the option with the unit, one line
  // If true, only numbers without a fraction are valid.
  bool whole = false;
  // If not null, the value is a text, and this function returns whether `value` is valid.
  bool (*is_valid)(std::string_view value) = nullptr;
  // If not null, users may also give the name of a file. This function returns the value in that file, and
  // returns valid values unchanged. Then a recording does not depend on the file.
  Result<std::string> (*load)(const std::string& value) = nullptr;
};

// Returns the valid values for messages, such as "keep|straight|home" or "1 to 20".
std::string valid_values(const Option& option);

class OptionValues {
 public:
  // Returns the value of each option: the value in `given`, or else the default. Errors (usage): a name is
  // unknown, or a value is not valid for its option. The message lists the valid names or values.
  static Result<OptionValues> parse(std::span<const Option> options,
                                    const std::map<std::string, std::string>& given);

  // Returns the value of an option that is a number. Both number() and choice() throw std::out_of_range if
  // `name` is not a parsed option of the matching type.
  double number(std::string_view name) const;
  // Returns the value of an option that is a choice or a text.
  const std::string& choice(std::string_view name) const;

 private:
  std::map<std::string, double, std::less<>> numbers_;
  std::map<std::string, std::string, std::less<>> choices_;
};

}  // namespace kaz::behavior
