// Converts simulated time from states (periods of the board's crystal) to nanoseconds, and back.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/time.hpp"
#include "shared/board/board.h"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

// Rounds down. The frequency of the board's crystal is 18.432 MHz. Therefore one state lasts about 54.25 ns
// (exactly 15,625 ns divided by 288). A millisecond is a whole number of states and of nanoseconds.
constexpr Time time_of(States states) {
  return Time(states * 15625 / 288);
}
// Returns the first state at or after `t`.
constexpr States states_of(Time t) {
  return (t.count() * 288 + 15624) / 15625;
}

static_assert(15625 * (KZ_CLOCK_HZ / 1000) == 288 * 1000000L);

}  // namespace kaz::sim
