// Steps of the world that are shorter or longer than the firmware's tick.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation/step_ratio.h"

#include <gtest/gtest.h>

#include "sim/mcu/host_testing.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

TEST(StepRatio, TakesTheSixLengthsAndNoOther) {
  EXPECT_EQ(step_ratio(0.125)->steps_a_tick, 8);
  EXPECT_EQ(step_ratio(0.25)->steps_a_tick, 4);
  EXPECT_EQ(step_ratio(1000 * (0.5 / 1000))->steps_a_tick, 2);
  EXPECT_EQ(step_ratio(1)->steps_a_tick * step_ratio(1)->ticks_a_step, 1);
  EXPECT_EQ(step_ratio(2)->ticks_a_step, 2);
  EXPECT_EQ(step_ratio(4)->ticks_a_step, 4);
  for (const double wrong : {0.0, -1.0, 0.1, 0.3, 0.75, 1.5, 3.0, 5.0, 8.0, std::nan("")}) {
    const auto ratio = step_ratio(wrong);
    ASSERT_FALSE(ratio) << wrong;
    EXPECT_EQ(ratio.error().fault, Fault::usage);
    EXPECT_NE(ratio.error().message.find("give 0.125"), std::string::npos);
  }
}

const TestWorld& world_of(const Simulation& simulation) {
  return dynamic_cast<const TestWorld&>(simulation.world());
}

// Whatever the step, the servo reaches its target: 0.3 rad with the gains of the start.
TEST(StepRatio, TheLoopClosesUnderEachLength) {
  for (const double step_ms : {0.125, 0.5, 1.0, 2.0, 4.0}) {
    SimulationOptions options;
    options.sensors = SensorSet::ideal;
    auto simulation = test_simulation(options, step_ms / 1000);
    ASSERT_NE(simulation, nullptr) << step_ms;
    for (int i = 0; i < 48; ++i) ASSERT_TRUE(simulation->step());
    EXPECT_EQ(world_of(*simulation).steps(), std::lround(48 / step_ms));
    simulation->write(enable_frame(1, 1));
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(simulation->step());
    simulation->write(target_frame(2, 0, 3000));
    for (int i = 0; i < 400; ++i) {
      ASSERT_TRUE(simulation->step());
      if (i % 50 == 0)
        simulation->write(
            frame_of(KZ_TYPE_heartbeat, static_cast<std::uint8_t>(3 + i / 50), {0, 0}));
    }
    EXPECT_NEAR(world_of(*simulation).joints()[0].angle, 0.3, 0.01) << step_ms;
  }
}

// Under a long step the drive is the mean of the ticks: a duty that rises during them is met in between.
TEST(StepRatio, ALongStepTakesTheMeanDuty) {
  const auto duties = [](double step_s, int ms) {
    SimulationOptions options;
    options.sensors = SensorSet::ideal;
    auto simulation = test_simulation(options, step_s);
    for (int i = 0; i < 48; ++i) EXPECT_TRUE(simulation->step());
    simulation->write(enable_frame(1, 1));
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(simulation->step());
    simulation->write(target_frame(2, 0, 3000));
    std::vector<double> duty;
    for (int i = 0; i < ms; ++i) {
      EXPECT_TRUE(simulation->step());
      duty.push_back(world_of(*simulation).last_duty());
    }
    return duty;
  };
  const auto each = duties(0.001, 12), both = duties(0.002, 12);
  // Up to the first motion both worlds are the same, and so are the firmware's outputs.
  std::size_t first = 0;
  while (first < each.size() && each[first] == 0) ++first;
  ASSERT_LT(first, 11u);
  const std::size_t pair = first / 2 * 2;
  EXPECT_NEAR(both[pair + 1], (each[pair] + each[pair + 1]) / 2, first % 2 == 1 ? 1e-12 : 0.02);
  EXPECT_GT(both[pair + 1], 0);
}

TEST(StepRatio, AssembleRefusesAWorldThatDoesNotFit) {
  SimulationOptions options;
  options.make_renderer = make_test_renderer;
  const auto made = Simulation::assemble(options, make_native(), std::make_unique<TestWorld>(0.003),
                                         small_camera());
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().message.find("3 ms"), std::string::npos);
}

// Saved between two steps of the world it goes on as if nothing had happened.
TEST(StepRatio, AShortOrLongStepCanBeSaved) {
  for (const double step_ms : {0.25, 4.0}) {
    SimulationOptions options;
    options.mcu = McuKind::native;
    options.world_path = "sim/worlds/ball.sdf";
    options.robot_path = "shared/robot/kaz/kaz.urdf";
    options.camera_path = "shared/robot/kaz/camera.json";
    options.physics_step_ms = step_ms;
    options.make_renderer = make_test_renderer;
    auto one = Simulation::create(options), other = Simulation::create(options);
    ASSERT_TRUE(one && other);
    (*one)->write(enable_frame(1, 1));
    for (int i = 0; i < 57; ++i) ASSERT_TRUE((*one)->step());  // a tick into a step of 4
    const auto saved = (*one)->save();
    ASSERT_TRUE(saved);
    ASSERT_TRUE((*other)->restore(*saved));
    for (int i = 0; i < 50; ++i) {
      ASSERT_TRUE((*one)->step());
      ASSERT_TRUE((*other)->step());
    }
    EXPECT_EQ(*(*one)->save(), *(*other)->save()) << step_ms;
  }
}

}  // namespace
}  // namespace kaz::sim
