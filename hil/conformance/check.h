// How a case fails: by an exception that its runner catches.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kaz::hil {

// What was wrong, in one sentence.
struct Failed {
  std::string message;
};

inline void check(bool holds, const std::string& else_what) {
  if (!holds) throw Failed{else_what};
}

inline void equal(const std::string& what, long got, long wanted) {
  check(got == wanted,
        what + ": expected " + std::to_string(wanted) + ", got " + std::to_string(got));
}

inline void within(const std::string& what, long got, long low, long high) {
  check(got >= low && got <= high, what + ": expected " + std::to_string(low) + ".." +
                                       std::to_string(high) + ", got " + std::to_string(got));
}

}  // namespace kaz::hil
