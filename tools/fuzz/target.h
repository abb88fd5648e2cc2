// A fuzz target: a function that accepts any bytes and returns the violation that the bytes cause, if any.
// SPDX-License-Identifier: Apache-2.0
//
// If the code under test returns an error, this is no violation. Violations are a crash, undefined behavior,
// an invalid result, or an error message that is not one sentence with the name of the error's source.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace kaz::fuzz {

using Bytes = std::span<const std::uint8_t>;
// Description of a violation; nullopt: no violation.
using Complaint = std::optional<std::string>;

struct Target {
  const char* name;
  Complaint (*run)(Bytes);
  // Number of cases with damaged seeds and noise that the tests of every build run. Targets whose cases run
  // quickly have more cases.
  int damaged_cases = 200;
};

}  // namespace kaz::fuzz
