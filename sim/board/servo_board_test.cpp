// The board around a microcontroller that does what the test says.
// SPDX-License-Identifier: Apache-2.0
#include "sim/board/servo_board.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kaz::sim {
namespace {

constexpr double deg = std::numbers::pi / 180.0;
constexpr States ms = KZ_STATES_PER_TICK;

// Changes its pins at given times and lets the test use its converter.
class ScriptedMcu final : public Mcu {
 public:
  std::string engine() const override { return "scripted"; }
  States now() const override { return now_; }
  Result<void> run_until(States until) override {
    while (!script.empty() && script.front().first <= until) {
      pins_ = script.front().second;
      listener_(script.front().first, pins_);
      script.erase(script.begin());
    }
    now_ = until;
    return {};
  }
  void reset() override { pins_ = {}; }
  std::array<std::uint8_t, memory_size> memory() const override { return {}; }
  void set_memory(std::span<const std::uint8_t, memory_size>) override {}
  void power_cycle() override {
    pins_ = {};
    ++power_cycles;
  }
  const PinLevels& pins() const override { return pins_; }
  void on_pins(std::function<void(States, const PinLevels&)> listener) override {
    listener_ = std::move(listener);
  }
  void set_analog(AnalogSource source) override { analog = std::move(source); }
  void receive(const SerialByte& byte) override { received.push_back(byte); }
  std::vector<SerialByte> take_transmitted() override { return std::exchange(to_send, {}); }
  void on_tick(std::function<void(const TickRecord&)>) override {}

  std::vector<std::pair<States, PinLevels>> script;
  std::vector<SerialByte> received, to_send;
  AnalogSource analog;
  int power_cycles = 0;

 private:
  PinLevels pins_;
  States now_ = 0;
  std::function<void(States, const PinLevels&)> listener_;
};

struct Bench {
  explicit Bench(ServoBoardOptions options = {.noise = false})
      : mcu(new ScriptedMcu), board(std::unique_ptr<Mcu>(mcu), options) {}

  double read(int mux, int input, States at = 0) {
    PinLevels levels;
    levels.p4 = static_cast<std::uint8_t>(input);
    return mcu->analog(mux, levels, at);
  }

  ScriptedMcu* mcu;
  ServoBoard board;
};

PinLevels enabled() {
  PinLevels pins;
  pins.p4 = KZ_P4_ENABLE;
  return pins;
}

TEST(Multiplexers, PutEachPotentiometerWhereTheWiringSays) {
  Bench bench;
  std::array<double, KZ_JOINTS> angles{};
  // Sign, centre and place of these four are from joints.def; 19 degrees are a tenth of the range.
  angles[1] = (15.0 + 19.0) * deg;    // neck_tilt: mux 0 input 1, sign +1, centre 15
  angles[5] = (-25.0 - 38.0) * deg;   // l_hand: mux 0 input 5, sign +1, centre -25
  angles[6] = (-50.0 + 19.0) * deg;   // r_sh_pitch: mux 1 input 0, sign -1, centre -50
  angles[17] = (-10.0 - 57.0) * deg;  // r_ankle_pitch: mux 2 input 5, sign -1, centre -10
  bench.board.set_joint_angles(angles);
  EXPECT_NEAR(bench.read(0, 1), 0.6, 1e-12);
  EXPECT_NEAR(bench.read(0, 5), 0.3, 1e-12);
  EXPECT_NEAR(bench.read(1, 0), 0.4, 1e-12);
  EXPECT_NEAR(bench.read(2, 5), 0.8, 1e-12);
}

TEST(Multiplexers, PutSupplyReferenceAndTemperatureOnTheSpareInputs) {
  Bench bench({.noise = false, .supply_volts = 10.0, .supply_ohms = 0.15, .driver_celsius = 25.6});
  EXPECT_NEAR(bench.read(0, 6), 10.0 / 15.36, 1e-12);
  EXPECT_EQ(bench.read(0, 7), 0.5);
  EXPECT_NEAR(bench.read(1, 6), 0.25, 1e-12);  // 25.6 of 102.4 degrees
  EXPECT_EQ(bench.read(2, 7), 0.0);            // not connected: grounded
  EXPECT_EQ(bench.read(3, 0), 0.0);            // AN3 without the gyro option
}

TEST(Potentiometer, StopsAtTheEndsOfItsTrack) {
  EXPECT_EQ(pot_ratio(0, 100 * deg), 1.0);
  EXPECT_EQ(pot_ratio(0, -100 * deg), 0.0);
  EXPECT_NEAR(pot_ratio(0, 95 * deg), 1.0, 1e-12);
}

TEST(Noise, DependsOnSeedTickAndInputAlone) {
  Bench a({.seed = 1}), b({.seed = 1}), other({.seed = 2});
  b.read(0, 3, 5 * ms);  // reading more often changes nothing
  EXPECT_EQ(a.read(0, 0, 7 * ms), b.read(0, 0, 7 * ms + 900));
  EXPECT_NE(a.read(0, 0, 7 * ms), other.read(0, 0, 7 * ms));
  EXPECT_NE(a.read(0, 0, 7 * ms), a.read(0, 0, 8 * ms));
  EXPECT_NE(a.read(0, 0, 7 * ms) - 0.5, a.read(1, 4, 7 * ms) - 0.5);
}

TEST(Noise, HasHalfACodeSigma) {
  Bench bench({.seed = 1});
  double squares = 0;
  constexpr int count = 20000;
  for (int t = 0; t < count; ++t) {
    const double codes = (bench.read(0, 0, t * ms) - 0.5) * 1024;
    squares += codes * codes;
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.5, 0.0125);  // five standard errors
}

TEST(Supply, SagsUnderLoad) {
  Bench bench;
  bench.board.set_supply_current(4.0);
  EXPECT_NEAR(bench.board.supply_volts(), 10.0 - 0.15 * 4.0, 1e-12);
  EXPECT_NEAR(bench.read(0, 6), 9.4 / 15.36, 1e-12);
}

TEST(Drives, AreIntegratedOverChangesWithinTheStep) {
  Bench bench;
  PinLevels first = enabled();
  first.pw[0] = 128;   // neck_pan, sign +1
  first.p3 = 0x01;     // forward
  first.pw[5] = 64;    // r_sh_pitch, sign -1, backward: the joint turns positively
  first.tmo[1] = 256;  // r_hand on TMO1 at a constant high level, sign -1
  first.p6 = 0x02;     // forward
  PinLevels second = first;
  second.p3 = 0x00;
  bench.mcu->script = {{0, first}, {ms * 3 / 4, second}};
  ASSERT_TRUE(bench.board.run_until(ms));
  auto drives = bench.board.take_drives();
  EXPECT_NEAR(drives[0].duty, 0.5 * 0.75 - 0.5 * 0.25, 1e-12);
  EXPECT_NEAR(drives[6].duty, 0.25, 1e-12);
  EXPECT_NEAR(drives[9].duty, -1.0, 1e-12);
  EXPECT_EQ(drives[1].duty, 0.0);
  for (const MeanDrive& drive : drives) EXPECT_TRUE(drive.powered);

  ASSERT_TRUE(bench.board.run_until(2 * ms));
  drives = bench.board.take_drives();
  EXPECT_NEAR(drives[0].duty, -0.5, 1e-12);
}

TEST(Drives, AreOffWhileTheDriversAre) {
  Bench bench;
  PinLevels off;
  off.pw[0] = 255;
  off.p3 = 0x01;
  PinLevels on = off;
  on.p4 = KZ_P4_ENABLE;
  bench.mcu->script = {{0, off}, {ms + ms / 4, on}};
  ASSERT_TRUE(bench.board.run_until(ms));
  auto drives = bench.board.take_drives();
  EXPECT_EQ(drives[0].duty, 0.0);
  EXPECT_FALSE(drives[0].powered);
  ASSERT_TRUE(bench.board.run_until(2 * ms));
  drives = bench.board.take_drives();
  EXPECT_NEAR(drives[0].duty, 0.75 * 255 / 256, 1e-12);
  EXPECT_TRUE(drives[0].powered);
}

TEST(Drives, SelectsDoNotMatter) {
  Bench bench;
  PinLevels pins = enabled();
  pins.pw[0] = 100;
  for (int i = 0; i < 8; ++i) {
    pins.p4 = static_cast<std::uint8_t>(KZ_P4_ENABLE | i);
    bench.mcu->script.emplace_back(i * 1000, pins);
  }
  ASSERT_TRUE(bench.board.run_until(ms));
  EXPECT_NEAR(bench.board.take_drives()[0].duty, -100.0 / 256, 1e-12);
  EXPECT_EQ(bench.board.pins().p4, KZ_P4_ENABLE | 7);
}

TEST(Power, OffStopsMotorsChipAndLineButNotTime) {
  Bench bench;
  PinLevels pins = enabled();
  pins.pw[0] = 255;
  bench.mcu->script = {{0, pins}};
  ASSERT_TRUE(bench.board.run_until(ms));
  bench.board.take_drives();

  bench.board.set_power(false);
  EXPECT_EQ(bench.board.supply_volts(), 0.0);
  EXPECT_FALSE(bench.board.drivers_enabled());
  bench.board.receive({0x55, ms + 1600, false});
  ASSERT_TRUE(bench.board.run_until(11 * ms));
  EXPECT_EQ(bench.board.now(), 11 * ms);
  EXPECT_EQ(bench.mcu->now(), ms);
  EXPECT_TRUE(bench.mcu->received.empty());
  EXPECT_FALSE(bench.board.take_drives()[0].powered);

  bench.board.set_power(true);
  EXPECT_EQ(bench.mcu->power_cycles, 1);
  // The chip's clock stood still for 10 ms; the line's times are translated.
  bench.board.receive({0x55, 11 * ms + 1600, false});
  ASSERT_EQ(bench.mcu->received.size(), 1u);
  EXPECT_EQ(bench.mcu->received[0].at, ms + 1600);
  bench.mcu->to_send = {{0xaa, 2 * ms, false}};
  ASSERT_TRUE(bench.board.run_until(12 * ms));
  EXPECT_EQ(bench.board.take_transmitted().at(0).at, 12 * ms);
}

}  // namespace
}  // namespace kaz::sim
