// What a behaviour can be told: named numbers and choices with defaults.
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
  std::string_view initial;  // value where none is given
  std::string_view choices;  // "keep|straight|home"; empty: a number from `least` to `most`
  double least = 0, most = 0;
  std::string_view text;  // one line, with the unit
};

class OptionValues {
 public:
  // The defaults overridden by `given`. Fails (usage) for a name that is not in `options`, a text
  // that is no number, and a value outside its range or choices; the sentence lists what is
  // possible.
  static Result<OptionValues> parse(std::span<const Option> options,
                                    const std::map<std::string, std::string>& given);

  // Only for names in the options that were parsed.
  double number(std::string_view name) const { return numbers_.find(name)->second; }
  const std::string& choice(std::string_view name) const { return choices_.find(name)->second; }

 private:
  std::map<std::string, double, std::less<>> numbers_;
  std::map<std::string, std::string, std::less<>> choices_;
};

}  // namespace kaz::behavior
