// For tests: changes bytes in saved states of a microcontroller, restores the states and runs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "sim/mcu/host_testing.h"

namespace kaz::sim {

inline std::vector<std::uint8_t> saved_state(Mcu& mcu) {
  StateWriter to;
  mcu.save(to);
  EXPECT_TRUE(to.good()) << to.error();
  return to.bytes();
}

// Restores `state`, sends a request, and runs for `states` states. Returns the archive's error, or an empty
// string if the state was accepted.
inline std::string restore_and_run(Mcu& mcu, const std::vector<std::uint8_t>& state, States states) {
  StateReader from(state);
  mcu.restore(from);
  if (from.good()) send(mcu, frame_of(KZ_TYPE_joints, 9, {0, 0, 0, 7}));
  (void)mcu.run_until(mcu.now() + states);  // a chip may stop with a report
  (void)mcu.take_transmitted();
  (void)mcu.memory();
  return from.error();
}

// Tries states in which one byte of a valid state is replaced: every `stride`th byte in [begin, end). The
// microcontroller must reject the state, or run from the state without a sanitizer report. After all tries,
// the valid state must run as at the beginning. For the emulated chip only time, memory and pins are
// compared, because translated code records jumps more rarely.
inline void sweep_state(Mcu& mcu, const std::vector<std::uint8_t>& valid, std::size_t begin,
                        std::size_t end, std::size_t stride, States states) {
  ASSERT_LE(end, valid.size());
  ASSERT_EQ(restore_and_run(mcu, valid, states), "");
  const bool exact = mcu.emulator_engine().empty();
  const auto outcome = [&] {
    return std::tuple(mcu.now(), mcu.pins(), mcu.memory(),
                      exact ? saved_state(mcu) : std::vector<std::uint8_t>());
  };
  const auto expected = outcome();
  std::size_t refused = 0;
  for (std::size_t at = begin; at < end; at += stride) {
    auto damaged = valid;
    const auto next = static_cast<std::uint8_t>(valid[at] + 1);
    const std::array<std::uint8_t, 4> values{0xff, 0x80, next, 0x10};
    damaged[at] = values[at / stride % values.size()];
    if (!restore_and_run(mcu, damaged, states).empty()) ++refused;
  }
  EXPECT_GT(refused, (end - begin) / stride / 100) << "the restore checks too little";
  EXPECT_LT(refused, (end - begin) / stride);
  ASSERT_EQ(restore_and_run(mcu, valid, states), "");
  EXPECT_TRUE(outcome() == expected);
}

}  // namespace kaz::sim
