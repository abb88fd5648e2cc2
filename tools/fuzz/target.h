// A fuzz target: a function that takes any bytes and reports what is wrong, if anything.
// SPDX-License-Identifier: Apache-2.0
//
// Errors are fine, and expected. Wrong are a crash, undefined behaviour, an invalid result, and an error
// that is not one sentence naming its source.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace kaz::fuzz {

using Bytes = std::span<const std::uint8_t>;
using Complaint = std::optional<std::string>;

struct Target {
  const char* name;
  Complaint (*run)(Bytes);
  int damaged_cases =
      200;  // damaged seeds and noise in the tests of every build, by what one costs
};

}  // namespace kaz::fuzz
