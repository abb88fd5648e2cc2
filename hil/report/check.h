// Exceptions that end a case or measurement. The runner of the case or measurement catches these exceptions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <type_traits>
#include <utility>

#include "shared/base/result.hpp"

namespace kaz::hil {

// Exception: the port is lost or the program was interrupted, so further cases are pointless.
struct Lost {
  Error error;
};

// Returns the value of `result`. Throws Lost if `result` is an error. Use this function for steps that can
// fail only because the port is lost or the program was interrupted.
template <class T>
T sure(Result<T> result) {
  if (!result) throw Lost{result.error()};
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

// Exception: the case or measurement failed. `message` is one sentence.
struct Failed {
  std::string message;
};

// Throws Failed with `else_what` if the condition is false.
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
