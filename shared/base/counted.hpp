// Formats a number with a noun for messages: "1 case", "2 cases".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kaz {

// Returns the number and the noun. The noun must form its plural with s.
template <class Number>
std::string counted(Number number, const std::string& noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

}  // namespace kaz
