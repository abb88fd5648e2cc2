// A fuzz target: a function that accepts any bytes and returns a violation that they cause, if any.
// SPDX-License-Identifier: Apache-2.0
//
// To return an error is correct. Violations are a crash, undefined behavior, an invalid result, or an error
// that is not one sentence with the name of its source.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace kaz::fuzz {

using Bytes = std::span<const std::uint8_t>;
using Complaint = std::optional<std::string>;  // the violation

struct Target {
  const char* name;
  Complaint (*run)(Bytes);
  // Number of cases with damaged seeds and noise in the tests of every build. Targets with cheap cases have
  // more.
  int damaged_cases = 200;
};

}  // namespace kaz::fuzz
