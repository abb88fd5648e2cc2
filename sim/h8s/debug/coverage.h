// Instruction and branch coverage of a running chip.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "sim/h8s/chip/observer.h"

namespace kaz::h8s {

// Attach this observer to the chip (Chip::attach). The chip must outlive the observer.
class Coverage final : public Observer {
 public:
  explicit Coverage(const Chip& chip) : chip_(chip) {}

  struct Count {
    std::int64_t executed = 0;
    std::int64_t taken = 0, passed = 0;  // how often a conditional branch was taken and not taken
    bool branch = false;                 // conditional branch
    std::uint8_t length = 2;             // bytes
  };
  // Returns the counts by instruction address. Instructions that never ran are absent.
  const std::map<std::uint32_t, Count>& counts() const { return counts_; }

  // Returns a table with one line per function. The columns are bytes covered, size, share covered,
  // executions of the first instruction, and branches that always went one way. Bytes between functions
  // (constants, gaps) do not count. If the image does not state the size of a function, size and share are
  // "-". For a function without a size, the covered bytes are counted up to the next function.
  std::string text() const;
  // Returns an lcov tracefile for genhtml, with FN, DA and BRDA records. The image must have line numbers.
  std::string lcov() const;

  void executed(const Executed& e) override;

 private:
  const Chip& chip_;
  std::map<std::uint32_t, Count> counts_;
};

}  // namespace kaz::h8s
