// The native engine alone, observed at its pins.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/mcu/host_testing.h"
#include "sim/mcu/native_mcu.h"

namespace kaz::sim {
namespace {

constexpr States kMs = KZ_STATES_PER_TICK;
constexpr States kFirstTick = NativeOptions::kDefaultStartStates;

// Since the last tick became due.
States since_tick(States at) {
  return (at - kFirstTick) % kMs;
}

bool motors_on(const Mcu& mcu) {
  return (mcu.pins().p4 & KZ_P4_ENABLE) != 0;
}

std::unique_ptr<Mcu> started() {
  auto mcu = make_native();
  mcu->set_analog(quiet_board);
  EXPECT_TRUE(mcu->run_until(60 * kMs));
  return mcu;
}

TEST(Native, EnablesAndDrivesTowardsATarget) {
  auto mcu = started();
  EXPECT_FALSE(motors_on(*mcu));
  EXPECT_EQ(mcu->pins().pw[0], 0);

  const States sent = send(*mcu, enable_frame(1, 1));
  ASSERT_TRUE(mcu->run_until(sent + 3 * kMs));
  EXPECT_TRUE(motors_on(*mcu));
  EXPECT_LE(mcu->pins().pw[0], 3);  // it holds its position

  // 0.2 rad ahead at kp 16/rad is three times full duty; the ramp of 6 rad/s gets there in 34 ms.
  const States targeted = send(*mcu, target_frame(2, 0, 2000));
  ASSERT_TRUE(mcu->run_until(targeted + 50 * kMs));
  EXPECT_EQ(mcu->pins().pw[0], 255);
  EXPECT_TRUE(mcu->pins().p3 & 1);  // neck_pan: P30 high is forward, mounted with sign +1

  const States back = send(*mcu, target_frame(3, 0, -2000));
  ASSERT_TRUE(mcu->run_until(back + 80 * kMs));
  EXPECT_EQ(mcu->pins().pw[0], 255);
  EXPECT_FALSE(mcu->pins().p3 & 1);
}

TEST(Native, SilentHostTurnsMotorsOffAfter90Milliseconds) {
  auto mcu = started();
  const States sent = send(*mcu, enable_frame(1, 1));
  ASSERT_TRUE(mcu->run_until(sent + 85 * kMs));
  EXPECT_TRUE(motors_on(*mcu));
  ASSERT_TRUE(mcu->run_until(sent + 95 * kMs));
  EXPECT_FALSE(motors_on(*mcu));
}

TEST(Native, BytesLeaveBackToBack) {
  auto mcu = started();
  send(*mcu, frame_of(KZ_TYPE_state, 7, {}));
  ASSERT_TRUE(mcu->run_until(mcu->now() + 20 * kMs));
  const auto bytes = mcu->take_transmitted();
  // Status: tick 4, status 2, supply 2, 18 angles; header 3, stuffing 1, check 3, two zeros.
  ASSERT_EQ(bytes.size(), 8u + 36 + 3 + 1 + 3 + 2);
  EXPECT_EQ(since_tick(bytes.front().at - KZ_STATES_PER_BYTE), 445);
  for (std::size_t i = 1; i < bytes.size(); ++i)
    EXPECT_EQ(bytes[i].at - bytes[i - 1].at, KZ_STATES_PER_BYTE);
  const auto bodies = bodies_of(bytes);
  ASSERT_EQ(bodies.size(), 1u);
  EXPECT_EQ(bodies[0][1], KZ_TYPE_state_reply);
  EXPECT_EQ(bodies[0][2], 7);
  EXPECT_TRUE(mcu->take_transmitted().empty());
}

TEST(Native, ByteIsNotThereBeforeItsStopBit) {
  auto mcu = started();
  send(*mcu, frame_of(KZ_TYPE_state, 1, {}));
  States first = 0;
  while (first == 0) {
    ASSERT_TRUE(mcu->run_until(mcu->now() + 100));
    const auto bytes = mcu->take_transmitted();
    if (!bytes.empty()) {
      first = bytes.front().at;
      EXPECT_EQ(bytes.size(), 1u);
      EXPECT_LE(first, mcu->now());
      EXPECT_GT(first, mcu->now() - 100);
    }
  }
}

TEST(Native, SamplesEveryInputWithItsSelect) {
  auto mcu = make_native();
  mcu->set_analog([](int channel, const PinLevels& levels, States) {
    // The inertial option's channels have the codes of the inputs that they replace.
    constexpr int kInertial[] = {KZ_ANALOG_YAW_RATE, KZ_ANALOG_FORWARD_FORCE, KZ_ANALOG_LEFT_FORCE};
    const int place =
        channel < KZ_MUXES ? channel * 8 + (levels.p4 & 7) : kInertial[channel - KZ_MUXES];
    return (place + 0.5) / KZ_POT_CODES;
  });
  kz_tick_input last{};
  mcu->on_tick([&last](const TickRecord& record) { last = record.input; });
  ASSERT_TRUE(mcu->run_until(60 * kMs));
  for (unsigned i = 0; i < KZ_ANALOG; ++i) EXPECT_EQ(last.analog[i], i);
}

TEST(Native, ConvertsEveryInputBeforeTheFirstTick) {
  auto mcu = make_native();
  mcu->set_analog(quiet_board);
  std::vector<u16> supply;
  mcu->on_tick([&supply](const TickRecord& record) {
    supply.push_back(record.input.analog[KZ_ANALOG_SUPPLY]);
  });
  ASSERT_TRUE(mcu->run_until(60 * kMs));
  ASSERT_FALSE(supply.empty());
  EXPECT_EQ(supply.front(), 666);  // floor(1024 * 10 / 15.36)
}

TEST(Native, ConverterClips) {
  auto mcu = make_native();
  mcu->set_analog([](int channel, const PinLevels&, States) {
    return channel == 0 ? 1.0 : channel == 1 ? -0.1 : 1023.0 / 1024.0;
  });
  kz_tick_input last{};
  mcu->on_tick([&last](const TickRecord& record) { last = record.input; });
  ASSERT_TRUE(mcu->run_until(60 * kMs));
  EXPECT_EQ(last.analog[0], 1023);
  EXPECT_EQ(last.analog[8], 0);
  EXPECT_EQ(last.analog[16], 1023);
}

TEST(Native, FramingErrorReachesTheTick) {
  auto mcu = started();
  std::vector<u8> flags;
  mcu->on_tick([&flags](const TickRecord& record) {
    for (int i = 0; i < record.input.rx_count; ++i) flags.push_back(record.input.rx_flags[i]);
  });
  mcu->receive({0x55, mcu->now() + 1600, false});
  mcu->receive({0x55, mcu->now() + 3200, true});
  ASSERT_TRUE(mcu->run_until(mcu->now() + 3 * kMs));
  EXPECT_EQ(flags, (std::vector<u8>{0, KZ_RX_FRAMING}));
}

TEST(Native, TakesSixteenBytesATick) {
  auto mcu = started();
  std::vector<int> counts;
  mcu->on_tick([&counts](const TickRecord& record) { counts.push_back(record.input.rx_count); });
  for (int i = 0; i < 40; ++i) mcu->receive({0x55, mcu->now() + 1, false});
  ASSERT_TRUE(mcu->run_until(mcu->now() + 4 * kMs));
  EXPECT_EQ(counts, (std::vector<int>{16, 16, 8, 0}));
}

TEST(Native, PinsChangeOnlyAtTicksButForTheSelects) {
  auto mcu = started();
  PinLevels before = mcu->pins();
  mcu->on_pins([&before](States at, const PinLevels& now) {
    PinLevels masked = now;
    masked.p4 = static_cast<std::uint8_t>((now.p4 & ~7) | (before.p4 & 7));
    if (masked != before) {
      EXPECT_LT(since_tick(at), 1000);
    }
    before = now;
  });
  send(*mcu, enable_frame(1, 0x3ffff));
  ASSERT_TRUE(mcu->run_until(mcu->now() + 20 * kMs));
  EXPECT_TRUE(motors_on(*mcu));
}

TEST(Native, ResetLetsGoOfThePins) {
  auto mcu = started();
  send(*mcu, enable_frame(1, 1));
  ASSERT_TRUE(mcu->run_until(mcu->now() + 10 * kMs));
  ASSERT_TRUE(motors_on(*mcu));
  mcu->reset();
  EXPECT_EQ(mcu->pins(), PinLevels{});
  u32 first = 99;
  mcu->on_tick([&first](const TickRecord& record) {
    if (first == 99) first = record.input.tick;
  });
  ASSERT_TRUE(mcu->run_until(mcu->now() + 60 * kMs));
  EXPECT_EQ(first, 0u);
  EXPECT_FALSE(motors_on(*mcu));
}

// Bytes received while the board starts are lost, until SCI0 is enabled.
TEST(Native, ListensShortlyBeforeTheFirstTick) {
  auto mcu = make_native();
  mcu->set_analog(quiet_board);
  std::vector<u8> heard;
  u32 first = 99;
  mcu->on_tick([&](const TickRecord& record) {
    for (int i = 0; i < record.input.rx_count; ++i) heard.push_back(record.input.rx[i]);
    if (!heard.empty() && first == 99) first = record.input.tick;
  });
  mcu->receive({1, 20 * kMs, false});
  mcu->receive({2, kFirstTick - 3 * kMs, false});
  mcu->receive({3, kFirstTick - 2 * kMs, false});
  mcu->receive({4, kFirstTick + 600, false});   // the tick reads its ring at 650
  mcu->receive({5, kFirstTick + 2000, false});  // after it
  ASSERT_TRUE(mcu->run_until(60 * kMs));
  EXPECT_EQ(heard, (std::vector<u8>{3, 4, 5}));
  EXPECT_EQ(first, 0u);
}

TEST(Native, RequestedRestartIsReported) {
  auto mcu = started();
  std::vector<States> restarts;
  mcu->on_watchdog_reset([&restarts](States at) { restarts.push_back(at); });
  const States sent = send(*mcu, frame_of(KZ_TYPE_reset, 1, {KZ_KEY >> 8, KZ_KEY & 0xFF}));
  ASSERT_TRUE(mcu->run_until(sent + 20 * kMs));
  ASSERT_EQ(restarts.size(), 1u);
  EXPECT_LT(restarts[0], mcu->now());
  mcu->reset();
  ASSERT_TRUE(mcu->run_until(mcu->now() + 60 * kMs));
  EXPECT_EQ(restarts.size(), 1u);
}

}  // namespace
}  // namespace kaz::sim
