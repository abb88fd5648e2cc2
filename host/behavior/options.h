// Options of a behaviour: named numbers and choices with defaults.
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
  // "keep|straight|home"; empty: a number in [min, max]. Of a text (is_valid) its form, for messages.
  std::string_view choices = {};
  double min = 0, max = 0;
  std::string_view text = {};  // one line, with the unit
  bool whole = false;     // a number without fraction
  // Makes it a text: false for one of another form.
  bool (*is_valid)(std::string_view value) = nullptr;
};

// The valid values: "keep|straight|home", "1 to 20".
std::string valid_values(const Option& option);

class OptionValues {
 public:
  // The defaults overridden by `given`. Fails (usage) for an unknown name, a text that is not a number (of a
  // `whole` option: no whole one), and a value outside its range or choices; the message lists the valid
  // ones.
  static Result<OptionValues> parse(std::span<const Option> options,
                                    const std::map<std::string, std::string>& given);

  // Precondition: `name` is among the options that were parsed, and of this kind; else they throw
  // std::out_of_range with a sentence.
  double number(std::string_view name) const;
  const std::string& choice(std::string_view name) const;  // or text

 private:
  std::map<std::string, double, std::less<>> numbers_;
  std::map<std::string, std::string, std::less<>> choices_;
};

}  // namespace kaz::behavior
