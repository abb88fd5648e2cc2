// The host's own client against a simulation in the same process.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/lockstep.h"

#include <gtest/gtest.h>

#include "host/robot/robot.h"
#include "sim/mcu/host_testing.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::lockstep {
namespace {

using std::chrono::milliseconds;

TEST(LockstepClock, SleepingIsWhatMovesTime) {
  const auto simulation = sim::test_simulation();
  LockstepClock clock(*simulation);
  EXPECT_EQ(clock.now(), Time(0));
  ASSERT_TRUE(clock.sleep_until(milliseconds(20)));
  EXPECT_EQ(clock.now(), milliseconds(20));
  ASSERT_TRUE(clock.sleep_until(milliseconds(5)));  // long past
  EXPECT_EQ(clock.now(), milliseconds(20));
  ASSERT_TRUE(clock.sleep_until(Time(20'000'001)));  // whole milliseconds, never too early
  EXPECT_EQ(clock.now(), milliseconds(21));
}

TEST(LockstepLink, ReadWaitsForBytesOrTheDeadline) {
  const auto simulation = sim::test_simulation();
  LockstepClock clock(*simulation);
  LockstepLink link(*simulation);
  std::array<std::uint8_t, 64> buffer{};
  const auto nothing = link.read(buffer, milliseconds(50));
  ASSERT_TRUE(nothing);
  EXPECT_EQ(*nothing, 0u);
  EXPECT_EQ(clock.now(), milliseconds(50));

  ASSERT_TRUE(link.write(sim::frame_of(KZ_TYPE_state, 1, {})));
  const auto some = link.read(buffer, milliseconds(1000));
  ASSERT_TRUE(some);
  EXPECT_GT(*some, 0u);
  EXPECT_LT(clock.now(), milliseconds(60));
  const Time before = clock.now();
  ASSERT_TRUE(link.read(buffer, milliseconds(0)));  // a deadline in the past only looks
  EXPECT_EQ(clock.now(), before);
}

TEST(LockstepLink, KnowsHowLongAByteTakes) {
  const auto simulation = sim::test_simulation();
  // 10 bits at 115,200 baud
  EXPECT_NEAR(static_cast<double>(LockstepLink(*simulation).byte_time().count()), 1e10 / 115200, 1);
}

TEST(Lockstep, RobotOfTheHostMovesAJoint) {
  const auto simulation = sim::test_simulation();
  LockstepClock clock(*simulation);
  LockstepLink link(*simulation);
  auto robot = host::Robot::connect(link, clock);
  ASSERT_TRUE(robot) << robot.error().message;
  EXPECT_EQ(robot->identity().joints, KZ_JOINTS);
  ASSERT_TRUE(robot->enable(1u << host::neck_pan));
  const host::JointTarget target{host::neck_pan, 0.3};
  ASSERT_TRUE(robot->set_targets(std::span(&target, 1), milliseconds(100)));
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(clock.sleep_until(clock.now() + milliseconds(50)));
    ASSERT_TRUE(robot->heartbeat());
  }
  const auto state = robot->state();
  ASSERT_TRUE(state) << state.error().message;
  EXPECT_NEAR(state->angle[host::neck_pan], 0.3, 0.02);
  EXPECT_NEAR(simulation->world().joints()[host::neck_pan].angle, 0.3, 0.02);
}

TEST(LockstepCamera, DeliversBySimulatedTime) {
  const auto simulation = sim::test_simulation();
  LockstepClock clock(*simulation);
  {
    LockstepCamera camera(*simulation);
    EXPECT_EQ(camera.model().width, 32);
    ASSERT_TRUE(clock.sleep_until(milliseconds(47)));
    auto pair = camera.poll();
    ASSERT_TRUE(pair);
    EXPECT_FALSE(*pair);
    ASSERT_TRUE(clock.sleep_until(milliseconds(48)));  // exposed at 33 ms, 15 ms in transit
    pair = camera.poll();
    ASSERT_TRUE(pair && *pair);
    EXPECT_EQ((*pair)->info.exposure, milliseconds(33));
    EXPECT_EQ((*pair)->images.get()->left.rgb.size(), 32u * 24 * 3);
  }
  ASSERT_TRUE(clock.sleep_until(milliseconds(500)));
  EXPECT_EQ(simulation->pairs_dropped(), 0u);
  EXPECT_FALSE(simulation->next_pair()) << "closed eyes see nothing";
}

TEST(Lockstep, ErrorOfTheSimulationComesOutOfEveryCall) {
  sim::SimulationOptions options;
  options.make_renderer = []() -> Result<std::unique_ptr<sim::Renderer>> {
    return fail(Fault::environment, "no OpenGL here");
  };
  auto simulation = sim::Simulation::assemble(
      options, sim::make_native(), std::make_unique<sim::TestWorld>(), sim::small_camera());
  ASSERT_TRUE(simulation);
  LockstepClock clock(**simulation);
  LockstepLink link(**simulation);
  LockstepCamera camera(**simulation);
  const auto slept = clock.sleep_until(milliseconds(100));
  ASSERT_FALSE(slept);
  EXPECT_EQ(slept.error().message, "no OpenGL here");
  std::array<std::uint8_t, 8> buffer{};
  EXPECT_FALSE(link.read(buffer, milliseconds(200)));
  EXPECT_FALSE(link.write(buffer));
  EXPECT_FALSE(camera.poll());
  EXPECT_FALSE(clock.sleep_until(milliseconds(200)));
}

}  // namespace
}  // namespace kaz::lockstep
