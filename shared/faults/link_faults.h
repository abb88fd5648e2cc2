// Effects of faulty lines on bytes, in one direction.
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

// What arrives for one byte sent: up to three bytes, namely noise, the byte and its duplicate.
struct LineBytes {
  std::array<LineByte, 3> bytes{};
  std::size_t count = 0;
  Time delay{};  // after the time at which they would come
};

// A byte of 8N1 whose sender is `error` faster than its receiver, as the receiver samples it in the
// middle of its own bits. The line is idle (high) behind the byte.
LineByte sampled(std::uint8_t value, double error);

class LinkFaults {
 public:
  // `way` is to_board or to_host. The same seed, schedule and bytes give the same bytes.
  LinkFaults(std::uint64_t seed, Way way)
      : random_(mix64(seed ^ static_cast<std::uint64_t>(way) << 32)), way_(way) {}

  // The byte that would arrive at `t`, on the schedule's scale.
  LineBytes pass(const Schedule& schedule, Time t, LineByte byte);

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(random_);
  }

 private:
  Random random_;
  Way way_;
};

}  // namespace kaz::faults
