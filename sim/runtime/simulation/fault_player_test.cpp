// Faults as the board, the world and the line see them.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/mcu/host_testing.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

faults::Fault fault_of(const std::string& line) {
  const auto fault = faults::parse(line);
  EXPECT_TRUE(fault) << line << ": " << (fault ? "" : fault.error().message);
  return fault.value_or(faults::Fault{});
}

// A simulation whose newest tick can be looked at.
struct Bench {
  std::unique_ptr<Simulation> simulation;
  kz_tick_input input{};
  std::uint8_t sequence = 0;

  explicit Bench(const std::string& schedule = "", const std::string& recording = "") {
    SimulationOptions options;
    options.sensors = SensorSet::ideal;
    options.recording_path = recording;
    options.faults = faults::Schedule::parse(schedule, "test").value();
    simulation = test_simulation(options);
    if (recording.empty()) {
      simulation->board().mcu().on_tick([this](const TickRecord& tick) { input = tick.input; });
    }
  }
  void run(int ms) {
    for (int i = 0; i < ms; ++i) {
      if (i % 40 == 0) simulation->write(frame_of(KZ_TYPE_heartbeat, ++sequence, {0, 0}));
      ASSERT_TRUE(simulation->step());
    }
  }
  int code(int analog) const { return input.analog[analog]; }
};

TEST(FaultPlayer, PotentiometersOpenShortNoisyAndStuck) {
  Bench bench(
      "at 100 ms for 50 ms pot_open joint 0\nat 200 ms for 50 ms pot_short joint 0\n"
      "at 300 ms for 50 ms pot_noisy joint 0 sigma 20 codes\n");
  bench.run(90);
  EXPECT_EQ(bench.code(0), 512);
  bench.run(30);
  EXPECT_EQ(bench.code(0), 1023);
  bench.run(50);
  EXPECT_EQ(bench.code(0), 512);
  bench.run(50);
  EXPECT_EQ(bench.code(0), 0);
  bench.run(85);
  double square = 0;
  for (int i = 0; i < 40; ++i) {
    bench.run(1);
    square += std::pow(bench.code(0) - 512, 2);
  }
  EXPECT_NEAR(std::sqrt(square / 40), 20, 8);
  bench.run(60);
  EXPECT_EQ(bench.code(0), 512);
}

TEST(FaultPlayer, AStuckPotentiometerStaysBehindItsJoint) {
  Bench bench("at 100 ms for 400 ms pot_stuck joint 0\n");
  bench.run(60);
  bench.simulation->write(enable_frame(++bench.sequence, 1));
  bench.run(60);
  bench.simulation->write(target_frame(++bench.sequence, 0, 1000));
  bench.run(200);
  EXPECT_EQ(bench.code(0), 512);
  EXPECT_GT(bench.simulation->world().joints()[0].angle, 0.1);
  bench.run(200);
  EXPECT_GT(bench.code(0), 530);
}

TEST(FaultPlayer, SupplySagsAndBreaksDown) {
  Bench bench("at 100 ms for 50 ms power_sag 4 V\nat 200 ms for 50 ms power_brown_out\n");
  bench.run(90);
  EXPECT_NEAR(bench.simulation->board().supply_volts(), 9.85, 1e-9);
  bench.run(30);
  EXPECT_NEAR(bench.simulation->board().supply_volts(), 5.85, 1e-9);
  bench.run(60);
  const auto before = bench.input.tick;
  bench.run(45);
  EXPECT_FALSE(bench.simulation->board().power());
  bench.run(90);  // power comes back at 250 ms, and the board starts in 45 ms
  EXPECT_TRUE(bench.simulation->board().power());
  EXPECT_LT(bench.input.tick, before);
}

TEST(FaultPlayer, ABrownOutDoesNotSwitchOnWhatTheUserHasSwitchedOff) {
  Bench bench("at 100 ms for 50 ms power_brown_out\n");
  bench.simulation->board().set_power(false);
  bench.run(300);
  EXPECT_FALSE(bench.simulation->board().power());
}

TEST(FaultPlayer, ResetHappensOnce) {
  Bench bench("at 100 ms power_reset\n");
  // The board starts in 45 ms.
  bench.run(99);
  EXPECT_GT(bench.input.tick, 45u);
  bench.run(100);
  EXPECT_LT(bench.input.tick, 60u);
  EXPECT_GT(bench.input.tick, 45u);
}

TEST(FaultPlayer, LinkFaultsReachBothWays) {
  Bench bench;
  bench.run(60);
  bench.simulation->add_fault(fault_of("link_cut to board"));
  bench.simulation->write(enable_frame(9, 1));
  bench.run(30);
  EXPECT_FALSE(bench.simulation->board().drivers_enabled());
  bench.simulation->clear_faults();
  bench.simulation->line().drop_unread();
  bench.simulation->add_fault(fault_of("link_cut to host"));
  bench.simulation->write(enable_frame(10, 1));
  bench.run(30);
  EXPECT_TRUE(bench.simulation->board().drivers_enabled());
  std::array<std::uint8_t, 64> buffer{};
  EXPECT_EQ(bench.simulation->read(buffer), 0u);
}

TEST(FaultPlayer, LateBytesComeInOrder) {
  SerialLine line;
  const faults::Schedule schedule(
      {fault_of("for 1 ms link_delay 0.01"), fault_of("link_insert 0.5")});
  line.set_faults(&schedule);
  line.write(std::vector<std::uint8_t>(40, 7), 0);
  const auto bytes = line.take_for_board(KZ_CLOCK_HZ);
  EXPECT_GT(bytes.size(), 45u);
  EXPECT_GE(bytes.front().at, 10 * KZ_STATES_PER_TICK + KZ_STATES_PER_BYTE);
  for (std::size_t i = 1; i < bytes.size(); ++i) EXPECT_LE(bytes[i - 1].at, bytes[i].at);
}

TEST(FaultPlayer, AWeakMotorGetsAShareOfItsDuty) {
  const FaultPlayer player(faults::Schedule({fault_of("motor_weak joint 3 0.5")}));
  std::array<MotorDrive, KZ_JOINTS> drives{};
  drives[2] = drives[3] = {-0.8, true};
  player.apply(Time::zero(), drives);
  EXPECT_EQ(drives[2].duty, -0.8);
  EXPECT_EQ(drives[3].duty, -0.4);
}

TEST(FaultPlayer, GearsJamReverseAndSlip) {
  FaultPlayer player(
      faults::Schedule({fault_of("at 1 ms joint_stuck joint 0"), fault_of("joint_reversed joint 1"),
                        fault_of("joint_slipping joint 2 torque 0.1 Nm")}));
  std::array<MotorDrive, KZ_JOINTS> drives{};
  drives[1] = {0.5, true};
  player.apply(Time::zero(), drives);
  EXPECT_FALSE(drives[0].jammed);
  EXPECT_EQ(drives[1].duty, -0.5);
  EXPECT_EQ(drives[2].slip_nm, 0.1);
  player.apply(std::chrono::milliseconds(1), drives);
  EXPECT_TRUE(drives[0].jammed);
}

}  // namespace
}  // namespace kaz::sim
