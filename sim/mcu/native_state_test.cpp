// Saved states of the native board that are none: refused, and nothing is used as an index unchecked.
// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <functional>

#include "sim/mcu/native_state.h"
#include "sim/mcu/state_testing.h"

namespace kaz::sim {
namespace {

constexpr States kMs = KZ_STATES_PER_TICK;

// Amid traffic: requests in its queue, a reply on the wire, half a frame received.
std::unique_ptr<Mcu> busy_board() {
  auto mcu = make_native();
  mcu->set_analog(quiet_board);
  EXPECT_TRUE(mcu->run_until(60 * kMs));
  const States sent = send(*mcu, enable_frame(1, 7));
  EXPECT_TRUE(mcu->run_until(sent + 2 * kMs));
  for (std::uint8_t sequence = 2; sequence < 5; ++sequence)
    send(*mcu, frame_of(KZ_TYPE_joints, sequence, {0, 0, 1, 0xff}));
  EXPECT_TRUE(mcu->run_until(mcu->now() + 4 * kMs));
  return mcu;
}

// The kz_servo is the last structure but two, each behind its size.
std::size_t servo_at(const std::vector<std::uint8_t>& state) {
  return state.size() - sizeof(kz_tick_output) - 4 - sizeof(kz_tick_input) - 4 - sizeof(kz_servo);
}

TEST(NativeState, OneWithAnIndexOutOfRangeIsRefused) {
  using Change = std::function<void(kz_servo&)>;
  const std::pair<const char*, Change> changes[] = {
      {"memory_next", [](kz_servo& s) { s.memory_next = KZ_REQUESTS_REMEMBERED; }},
      {"queued", [](kz_servo& s) { s.queued = KZ_QUEUE + 1; }},
      {"replying", [](kz_servo& s) { s.replying = 2; }},
      {"queued and replying", [](kz_servo& s) { s.queued = KZ_QUEUE, s.replying = 1; }},
      {"prepared", [](kz_servo& s) { s.prepared = KZ_PAYLOAD_MAX, s.queued = 1; }},
      {"prepared, nothing queued", [](kz_servo& s) { s.prepared = 1, s.queued = 0; }},
      {"raw_joint", [](kz_servo& s) { s.raw_joint = KZ_JOINTS; }},
      {"enabled", [](kz_servo& s) { s.enabled = KZ_ALL_JOINTS + 1; }},
      {"fresh_targets", [](kz_servo& s) { s.fresh_targets = 0x80000000; }},
      {"action", [](kz_servo& s) { s.action = KZ_ACTION_LOADER + 1; }},
      {"pot_input", [](kz_servo& s) { s.joint[17].pot_input = KZ_ANALOG; }},
      {"ramp_limit", [](kz_servo& s) { s.joint[0].ramp_limit = 0; }},
      {"kp", [](kz_servo& s) { s.joint[3].kp = -1; }},
      {"kd", [](kz_servo& s) { s.joint[3].kd = 32767; }},
      {"joint of a reply",
       [](kz_servo& s) { s.queue[0].type = KZ_TYPE_settings, s.queue[0].parameter = KZ_JOINTS; }},
      {"joints of a reply",
       [](kz_servo& s) {
         s.remembered[3].type = KZ_TYPE_joints, s.remembered[3].parameter = KZ_ALL_JOINTS;
       }},
      {"targets of a reply",
       [](kz_servo& s) {
         s.queue[2].type = KZ_TYPE_read_targets, s.queue[2].parameter = 0xffffffff;
       }},
      {"receiver.length", [](kz_servo& s) { s.receiver.length = sizeof s.receiver.body + 1; }},
      {"receiver.state", [](kz_servo& s) { s.receiver.state = KZ_RECEIVE_OVERRUN + 1; }},
      {"sender.length", [](kz_servo& s) { s.sender.length = KZ_BODY_MAX + 1; }},
      {"sender.next", [](kz_servo& s) { s.sender.next = 50, s.sender.length = 49; }},
      {"sender.stage", [](kz_servo& s) { s.sender.stage = 8; }},
  };
  const auto mcu = busy_board();
  const auto valid = saved_state(*mcu);
  kz_servo servo{};
  std::memcpy(&servo, valid.data() + servo_at(valid), sizeof servo);
  ASSERT_GT(servo.queued, 0) << "the board has nothing to do";
  ASSERT_NE(servo.sender.length, 0) << "the board sends nothing";
  for (const auto& [name, change] : changes) {
    kz_servo changed = servo;
    change(changed);
    auto state = valid;
    std::memcpy(state.data() + servo_at(state), &changed, sizeof changed);
    StateReader from(state);
    mcu->restore(from);
    EXPECT_EQ(from.error(), "its servo is out of range") << name;
    EXPECT_TRUE(saved_state(*mcu) == valid) << name << ": a refused state has changed the board";
  }
}

TEST(NativeState, WhateverByteIsChangedItIsRefusedOrRuns) {
  const auto mcu = busy_board();
  const auto state = saved_state(*mcu);
  sweep_state(*mcu, state, Mcu::kMemorySize, state.size(), 1, 4 * kMs);
}

// Pulses of the flash, of which some are still to come.
TEST(NativeState, OneThatWritesFlashIsCheckedToo) {
  auto mcu = make_native();
  mcu->set_analog(quiet_board);
  EXPECT_TRUE(mcu->run_until(60 * kMs));
  const States sent = send(*mcu, frame_of(KZ_TYPE_store_calibration, 1, {}));
  EXPECT_TRUE(mcu->run_until(sent + 3 * kMs));
  const auto state = saved_state(*mcu);
  // The pulses are behind the cells, and begin with their number.
  ASSERT_GT(state[Mcu::kMemorySize], 0) << "no pulse is planned";
  const std::size_t pulses = 8 + state[Mcu::kMemorySize] * std::size_t{56};
  sweep_state(*mcu, state, Mcu::kMemorySize, Mcu::kMemorySize + pulses, 1, 40 * kMs);
}

TEST(NativeState, OneThatIsCutOffIsRefused) {
  const auto mcu = busy_board();
  const auto valid = saved_state(*mcu);
  for (std::size_t length = 0; length < valid.size(); length += 37) {
    const std::vector<std::uint8_t> cut(valid.begin(),
                                        valid.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_NE(restore_and_run(*mcu, cut, kMs), "") << length;
  }
}

}  // namespace
}  // namespace kaz::sim
