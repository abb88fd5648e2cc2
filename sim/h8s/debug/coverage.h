// Instruction and branch coverage.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "sim/h8s/chip/observer.h"

namespace kaz::h8s {

class Coverage final : public Observer {
 public:
  explicit Coverage(const Chip& chip) : chip_(chip) {}

  struct Count {
    std::int64_t executed = 0;
    std::int64_t taken = 0, passed = 0;  // of conditional branches
    bool branch = false;
    std::uint8_t length = 2;
  };
  // By instruction address; instructions that never ran are absent.
  const std::map<std::uint32_t, Count>& counts() const { return counts_; }

  // One line per function: instructions executed, bytes covered of its size, branches taken in one
  // direction only. What lies between a function's end and the next one (constants, gaps, code that is no
  // function) counts for neither. Where the image does not state a function's size its line has none, and
  // counts what is covered up to the next function.
  std::string text() const;
  // lcov's tracefile for genhtml: FN, DA and BRDA records, for images with line numbers.
  std::string lcov() const;

  void executed(const Executed& e) override;

 private:
  const Chip& chip_;
  std::map<std::uint32_t, Count> counts_;
};

}  // namespace kaz::h8s
