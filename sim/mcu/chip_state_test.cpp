// Saved states of the emulated board that are none: refused, or run without harm to this process.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/h8_mcu.h"
#include "sim/mcu/state_testing.h"

namespace kaz::sim {
namespace {

constexpr States kMs = KZ_STATES_PER_TICK;

std::unique_ptr<Mcu> busy_chip() {
  auto made = make_h8(KAZ_FIRMWARE_IMAGE);
  EXPECT_TRUE(made) << made.error().message;
  std::unique_ptr<Mcu> mcu = std::move(*made);
  mcu->set_analog(quiet_board);
  EXPECT_TRUE(mcu->run_until(100 * kMs));
  const States sent = send(*mcu, enable_frame(1, 7));
  EXPECT_TRUE(mcu->run_until(sent + 2 * kMs));
  const States requested = send(*mcu, frame_of(KZ_TYPE_joints, 2, {0, 0, 1, 0xff}));
  EXPECT_TRUE(mcu->run_until(requested + 2 * kMs));
  return mcu;
}

// What is behind flash and RAM, whose bytes a program may write anyway: CPU, interrupts, modules.
TEST(ChipState, WhateverByteIsChangedItIsRefusedOrRuns) {
  const auto mcu = busy_chip();
  const auto state = saved_state(*mcu);
  // In front of the flash are the board's members, then the length of the flash, without what is erased.
  StateReader from(state);
  States base = 0, hung_at = 0;
  std::vector<SerialByte> transmitted;
  PinLevels pins;
  bool hung = false;
  std::vector<std::uint8_t> flash;
  from(base, transmitted, pins, hung, hung_at);
  const std::size_t members = state.size() - from.left();
  from(flash);
  ASSERT_TRUE(from.good()) << from.error();
  ASSERT_GT(flash.size(), 30'000u);
  const std::size_t modules = state.size() - from.left() + 0x2000;
  ASSERT_LT(modules, state.size());
  sweep_state(*mcu, state, 0, members, 3, kMs);
  sweep_state(*mcu, state, modules, state.size(), 13, kMs);
}

TEST(ChipState, OneThatIsCutOffIsRefused) {
  const auto mcu = busy_chip();
  const auto valid = saved_state(*mcu);
  for (std::size_t length = 0; length < valid.size(); length += 1500) {
    const std::vector<std::uint8_t> cut(valid.begin(),
                                        valid.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_NE(restore_and_run(*mcu, cut, kMs), "") << length;
  }
}

}  // namespace
}  // namespace kaz::sim
