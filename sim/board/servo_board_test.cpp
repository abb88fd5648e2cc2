// The board around a microcontroller that the test controls.
// SPDX-License-Identifier: Apache-2.0
#include "sim/board/servo_board.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/base/angle.hpp"

namespace kaz::sim {
namespace {

constexpr States kMs = KZ_STATES_PER_TICK;

// Changes its pins at given times and lets the test use its converter.
class ScriptedMcu final : public Mcu {
 public:
  std::string name() const override { return "scripted"; }
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
  std::array<std::uint8_t, kMemorySize> memory() const override { return {}; }
  void set_memory(std::span<const std::uint8_t, kMemorySize>) override {}
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

// As robot and sensor file specify.
ServoBoardOptions nominal(std::uint64_t seed = 1) {
  return {.seed = seed, .params = load_sensor_file("shared/robot/kaz/sensors.xml").value()};
}

struct Bench {
  explicit Bench(ServoBoardOptions options = {.sensors = SensorSwitches::ideal()})
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
  angles[1] = (15.0 + 19.0) * kDegree;    // neck_tilt: mux 0 input 1, sign +1, centre 15
  angles[5] = (-25.0 - 38.0) * kDegree;   // l_hand: mux 0 input 5, sign +1, centre -25
  angles[6] = (-50.0 + 19.0) * kDegree;   // r_sh_pitch: mux 1 input 0, sign -1, centre -50
  angles[17] = (-10.0 - 57.0) * kDegree;  // r_ankle_pitch: mux 2 input 5, sign -1, centre -10
  bench.board.set_joint_angles(angles);
  EXPECT_NEAR(bench.read(0, 1), 0.6, 1e-12);
  EXPECT_NEAR(bench.read(0, 5), 0.3, 1e-12);
  EXPECT_NEAR(bench.read(1, 0), 0.4, 1e-12);
  EXPECT_NEAR(bench.read(2, 5), 0.8, 1e-12);
}

TEST(Multiplexers, PutSupplyReferenceAndTemperatureOnTheSpareInputs) {
  ServoBoardOptions options = nominal();
  options.sensors = SensorSwitches::ideal();
  options.params.driver.ambient_celsius = 25.6;
  Bench bench(options);
  EXPECT_NEAR(bench.read(0, 6), 10.0 / 15.36, 1e-12);
  EXPECT_EQ(bench.read(0, 7), 0.5);
  EXPECT_NEAR(bench.read(1, 6), 0.25, 1e-12);  // 25.6 of 102.4 degrees
  EXPECT_EQ(bench.read(2, 7), 0.0);            // not connected: grounded
  EXPECT_EQ(bench.read(3, 0), 0.0);            // AN3 without the gyro option
}

TEST(Noise, DependsOnSeedTickAndInputAlone) {
  Bench a(nominal(1)), b(nominal(1)), other(nominal(2));
  b.read(0, 3, 5 * kMs);  // repeated reads return the same
  EXPECT_EQ(a.read(0, 0, 7 * kMs), b.read(0, 0, 7 * kMs + 900));
  EXPECT_NE(a.read(0, 0, 7 * kMs), other.read(0, 0, 7 * kMs));
  EXPECT_NE(a.read(0, 0, 7 * kMs), a.read(0, 0, 8 * kMs));
  EXPECT_NE(a.read(0, 0, 7 * kMs) - 0.5, a.read(1, 4, 7 * kMs) - 0.5);
}

// One sigma at an input whose value is known, in codes.
double sigma_codes(Bench& bench, int mux, int input, double ratio) {
  double squares = 0;
  constexpr int count = 20000;
  for (int t = 0; t < count; ++t)
    squares += std::pow((bench.read(mux, input, t * kMs) - ratio) * 1024, 2);
  return std::sqrt(squares / count);
}

TEST(Noise, HasTheSigmaOfTheFile) {
  Bench bench(nominal());
  // Five standard errors of 20000 readings: 2.5 %.
  EXPECT_NEAR(sigma_codes(bench, 0, 0, 0.5), 0.5, 0.0125);
  EXPECT_NEAR(sigma_codes(bench, 0, 6, 10.0 / 15.36), 0.5, 0.0125);
  EXPECT_NEAR(sigma_codes(bench, 0, 7, 0.5), 0.25, 0.00625);
  EXPECT_NEAR(sigma_codes(bench, 1, 6, 25 / 102.4), 0.5, 0.0125);
  EXPECT_EQ(bench.read(2, 7), 0.0) << "tied to ground";
}

TEST(Noise, IsWhite) {
  // Neighbouring ticks and neighbouring inputs are independent: five standard errors.
  Bench bench(nominal());
  double in_time = 0, across = 0;
  constexpr int count = 20000;
  for (int t = 0; t < count; ++t) {
    const double x = 2048 * (bench.read(0, 0, t * kMs) - 0.5);
    in_time += x * 2048 * (bench.read(0, 0, (t + 1) * kMs) - 0.5);
    across += x * 2048 * (bench.read(2, 2, t * kMs) - 0.5);
  }
  EXPECT_NEAR(in_time / count, 0, 5 / std::sqrt(count));
  EXPECT_NEAR(across / count, 0, 5 / std::sqrt(count));
}

TEST(Noise, EachSensorHasItsSwitch) {
  struct {
    bool SensorSwitches::*member;
    int mux, input;
    double exact;
  } const cases[] = {{&SensorSwitches::potentiometer, 0, 0, 0.5},
                     {&SensorSwitches::supply, 0, 6, 10.0 / 15.36},
                     {&SensorSwitches::reference, 0, 7, 0.5},
                     {&SensorSwitches::temperature, 1, 6, 25 / 102.4}};
  for (const auto& one : cases) {
    ServoBoardOptions options = nominal();
    options.sensors.*one.member = false;
    Bench bench(options);
    for (const auto& input : cases) {
      const double read = bench.read(input.mux, input.input, 3 * kMs);
      if (&input == &one) {
        EXPECT_DOUBLE_EQ(read, input.exact);
      } else {
        EXPECT_GT(std::abs(read - input.exact), 1e-9);
      }
    }
  }
}

TEST(DriverTemperature, HeatsAsOneTimeConstantAndCoolsAgain) {
  Bench bench(nominal());
  // 0.6 V times 10 A are 6 W, 8 K/W: 48 degrees more in the end, 1 - 1/e of it after 320 s.
  bench.board.set_motor_current(10);
  ASSERT_TRUE(bench.board.run_until(320 * KZ_CLOCK_HZ));
  bench.board.set_motor_current(0);
  EXPECT_NEAR(bench.board.driver_celsius(), 25 + 48 * (1 - std::exp(-1)), 1e-9);
  ASSERT_TRUE(bench.board.run_until(640 * KZ_CLOCK_HZ));
  bench.board.set_motor_current(0);
  EXPECT_NEAR(bench.board.driver_celsius(), 25 + 48 * (1 - std::exp(-1)) * std::exp(-1), 1e-9);
}

TEST(DriverTemperature, IsTheSameInManySteps) {
  Bench once(nominal()), often(nominal());
  for (Bench* bench : {&once, &often}) bench->board.set_motor_current(5);
  for (int i = 1; i <= 1000; ++i) {
    ASSERT_TRUE(often.board.run_until(i * kMs));
    often.board.set_motor_current(5);
  }
  ASSERT_TRUE(once.board.run_until(1000 * kMs));
  once.board.set_motor_current(5);
  EXPECT_NEAR(once.board.driver_celsius(), often.board.driver_celsius(), 1e-9);
}

TEST(ImuOption, StandsOnAn3ToAn5AndGroundWithoutIt) {
  ServoBoardOptions options = nominal();
  options.sensors = SensorSwitches::ideal();
  Bench without(options);
  options.imu = true;
  Bench with(options);
  for (Bench* bench : {&without, &with}) {
    ASSERT_TRUE(bench->board.run_until(kMs));
    bench->board.set_motion({.yaw_rate = 50 * kDegree, .forward_force = 0, .left_force = 9.80665});
  }
  EXPECT_NEAR(with.read(3, 0), 0.55, 1e-12);
  EXPECT_NEAR(with.read(4, 0), 0.5, 1e-12);
  EXPECT_NEAR(with.read(5, 0), 0.5624, 1e-12);
  for (const int channel : {3, 4, 5, 6, 7}) EXPECT_EQ(without.read(channel, 0), 0.0);
  for (const int channel : {6, 7}) EXPECT_EQ(with.read(channel, 0), 0.0);
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
  bench.mcu->script = {{0, first}, {kMs * 3 / 4, second}};
  ASSERT_TRUE(bench.board.run_until(kMs));
  auto drives = bench.board.take_drives();
  EXPECT_NEAR(drives[0].duty, 0.5 * 0.75 - 0.5 * 0.25, 1e-12);
  EXPECT_NEAR(drives[6].duty, 0.25, 1e-12);
  EXPECT_NEAR(drives[9].duty, -1.0, 1e-12);
  EXPECT_EQ(drives[1].duty, 0.0);
  for (const MeanDrive& drive : drives) EXPECT_TRUE(drive.powered);

  ASSERT_TRUE(bench.board.run_until(2 * kMs));
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
  bench.mcu->script = {{0, off}, {kMs + kMs / 4, on}};
  ASSERT_TRUE(bench.board.run_until(kMs));
  auto drives = bench.board.take_drives();
  EXPECT_EQ(drives[0].duty, 0.0);
  EXPECT_FALSE(drives[0].powered);
  ASSERT_TRUE(bench.board.run_until(2 * kMs));
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
  ASSERT_TRUE(bench.board.run_until(kMs));
  EXPECT_NEAR(bench.board.take_drives()[0].duty, -100.0 / 256, 1e-12);
  EXPECT_EQ(bench.board.pins().p4, KZ_P4_ENABLE | 7);
}

TEST(Power, OffStopsMotorsChipAndLineButNotTime) {
  Bench bench;
  PinLevels pins = enabled();
  pins.pw[0] = 255;
  bench.mcu->script = {{0, pins}};
  ASSERT_TRUE(bench.board.run_until(kMs));
  bench.board.take_drives();

  bench.board.set_power(false);
  EXPECT_EQ(bench.board.supply_volts(), 0.0);
  EXPECT_FALSE(bench.board.drivers_enabled());
  bench.board.receive({0x55, kMs + 1600, false});
  ASSERT_TRUE(bench.board.run_until(11 * kMs));
  EXPECT_EQ(bench.board.now(), 11 * kMs);
  EXPECT_EQ(bench.mcu->now(), kMs);
  EXPECT_TRUE(bench.mcu->received.empty());
  EXPECT_FALSE(bench.board.take_drives()[0].powered);

  bench.board.set_power(true);
  EXPECT_EQ(bench.mcu->power_cycles, 1);
  // The chip's clock was stopped for 10 ms; the line's times are shifted.
  bench.board.receive({0x55, 11 * kMs + 1600, false});
  ASSERT_EQ(bench.mcu->received.size(), 1u);
  EXPECT_EQ(bench.mcu->received[0].at, kMs + 1600);
  bench.mcu->to_send = {{0xaa, 2 * kMs, false}};
  ASSERT_TRUE(bench.board.run_until(12 * kMs));
  EXPECT_EQ(bench.board.take_transmitted().at(0).at, 12 * kMs);
}

}  // namespace
}  // namespace kaz::sim
