// Applies link faults to the bytes of one direction of a serial line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/base/random.hpp"
#include "shared/faults/faults.h"

namespace kaz::faults {

struct LineByte {
  std::uint8_t value = 0;
  bool framing_error = false;
};

// Bytes that arrive at the receiver for one sent byte. Link faults can add noise before the sent byte and a
// duplicate after it, and can drop the sent byte.
struct LineBytes {
  std::array<LineByte, 3> bytes{};
  std::size_t count = 0;
  Time delay{};  // additional delay
};

// Returns the byte that a receiver samples if its clock differs from the sender's clock. `error` is the rate
// of the sender's clock divided by the rate of the receiver's clock, minus 1. The byte is 8N1. The receiver
// samples each bit in the middle, according to its own clock. The line is idle (high) after the byte.
LineByte sampled(std::uint8_t value, double error);

// Random link faults. Not thread-safe.
class LinkFaults {
 public:
  // `way` is to_board or to_host. Two runs with the same seed, the same schedule, and the same bytes
  // sent at the same times give the same received bytes.
  LinkFaults(std::uint64_t seed, Way way)
      : random_(mix64(seed ^ static_cast<std::uint64_t>(way) << 32)), way_(way) {}

  // Applies the active faults of `schedule` to a byte that would arrive at `t`. `t` counts from the start of
  // the schedule.
  LineBytes pass(const Schedule& schedule, Time t, LineByte byte);

  // Saves or restores the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(random_);
  }

 private:
  Random random_;
  Way way_;
};

}  // namespace kaz::faults
