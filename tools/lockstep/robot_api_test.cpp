// Every message of the protocol through Robot, on a virtual board with flash.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/robot/robot.h"
#include "sim/runtime/simulation/world_testing.h"
#include "tools/lockstep/lockstep.h"

namespace kaz::lockstep {
namespace {

using namespace std::chrono_literals;
using host::JointTarget;

struct Api : ::testing::Test {
  std::unique_ptr<sim::Simulation> simulation = sim::test_simulation();
  LockstepClock clock{*simulation};
  LockstepLink link{*simulation};
  host::Robot robot = [this] {
    auto connected = host::Robot::connect(link, clock);
    if (!connected) throw std::runtime_error(connected.error().message);
    return std::move(*connected);
  }();
  void wait(Time time) { ASSERT_TRUE(robot.clock().sleep_until(clock.now() + time)); }
};

TEST_F(Api, GainsAndLimitsAreReadBack) {
  const host::Gains gains{
      .kp_per_rad = 12, .kd_s_per_rad = 0.2, .dead_band_rad = 0.02, .friction = 0.1};
  ASSERT_TRUE(robot.set_gains(1u << host::l_knee, gains));
  ASSERT_TRUE(robot.set_limits(1u << host::l_knee,
                               {.ramp_rad_per_s = 3, .lower_rad = -1, .upper_rad = 1.5}));
  const auto settings = robot.settings(host::l_knee);
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_NEAR(settings->gains.kp_per_rad, 12, 0.1);
  EXPECT_NEAR(settings->gains.kd_s_per_rad, 0.2, 0.01);
  EXPECT_NEAR(settings->gains.dead_band_rad, 0.02, 1e-4);
  EXPECT_NEAR(settings->gains.friction, 0.1, 0.003);
  EXPECT_NEAR(settings->limits.ramp_rad_per_s, 3, 1e-9);
  EXPECT_NEAR(settings->limits.lower_rad, -0.0872, 1e-9) << "cut to the mechanics";
  EXPECT_NEAR(settings->limits.upper_rad, 1.5, 1e-4);
  const auto other = robot.settings(host::r_knee);
  ASSERT_TRUE(other);
  EXPECT_NEAR(other->gains.kp_per_rad, host::Gains().kp_per_rad, 0.01) << "as after a reset";
  EXPECT_NEAR(other->gains.kd_s_per_rad, host::Gains().kd_s_per_rad, 1e-3);

  for (const host::Gains& wrong : {host::Gains{.kp_per_rad = 81}, host::Gains{.kd_s_per_rad = 1.1},
                                   host::Gains{.dead_band_rad = 0.2}, host::Gains{.friction = 0.5},
                                   host::Gains{.kp_per_rad = -1}})
    EXPECT_EQ(robot.set_gains(1, wrong).error().fault, Fault::usage);
  EXPECT_EQ(robot.set_limits(1, {.lower_rad = 1, .upper_rad = 0}).error().fault, Fault::usage);
  EXPECT_EQ(robot.set_gains(0, {}).error().fault, Fault::usage);
  EXPECT_EQ(robot.set_gains(1u << 18, {}).error().fault, Fault::usage);
  EXPECT_EQ(robot.settings(18).error().fault, Fault::usage);
}

TEST_F(Api, TargetsAndJointsInDetail) {
  ASSERT_TRUE(robot.enable(1u << host::neck_pan));
  const JointTarget target{host::neck_pan, 0.4};
  ASSERT_TRUE(robot.set_targets({&target, 1}, 400ms));
  wait(200ms);
  const auto targets = robot.read_targets();
  ASSERT_TRUE(targets) << targets.error().message;
  EXPECT_NEAR((*targets)[host::neck_pan], 0.4, 1e-4);
  EXPECT_NEAR((*targets)[host::l_elbow], 0, 0.01);
  const auto joints = robot.joints(host::kAllJoints);
  ASSERT_TRUE(joints) << joints.error().message;
  ASSERT_EQ(joints->size(), std::size_t{KZ_JOINTS});
  const host::JointDetail& pan = joints->front();
  EXPECT_EQ(pan.joint, host::neck_pan);
  EXPECT_EQ(pan.flags & (KZ_JOINT_ON | KZ_JOINT_MOVING), KZ_JOINT_ON | KZ_JOINT_MOVING);
  EXPECT_GT(pan.angle_rad, 0.1);
  EXPECT_GT(pan.duty, 0.05);
  EXPECT_EQ(joints->back().joint, KZ_JOINTS - 1);
  EXPECT_EQ(joints->back().flags & KZ_JOINT_ON, 0);
  // One code of the potentiometer in a tick is 3.2 rad/s, of which the filter passes an eighth: a single
  // reading is up to 0.5 rad/s off.
  constexpr int readings = 8;
  double sum = 0;
  for (int i = 0; i < readings; ++i) {
    wait(3ms);
    const auto now = robot.joints(1u << host::neck_pan);
    ASSERT_TRUE(now) << now.error().message;
    sum += now->front().speed_rad_per_s;
  }
  EXPECT_NEAR(sum / readings, 1, 0.2);
}

TEST_F(Api, StopLatchesInWordsUntilClear) {
  ASSERT_TRUE(robot.enable(host::kAllJoints));
  ASSERT_TRUE(robot.stop());
  const auto health = robot.health();
  ASSERT_TRUE(health) << health.error().message;
  EXPECT_EQ(health->shutdown, "emergency stop");
  EXPECT_FALSE(health->joint);
  EXPECT_GT(health->shutdown_tick, 0u);
  EXPECT_NEAR(health->supply_volts, 9.85, 0.1);
  EXPECT_NEAR(health->reference, 0.5, 0.01);
  const JointTarget target{host::neck_pan, 0.1};
  EXPECT_FALSE(robot.set_targets({&target, 1}, 0ms));
  EXPECT_FALSE(robot.take_resumption()) << "a stop is no lost link";
  ASSERT_TRUE(robot.clear());
  EXPECT_EQ(robot.health()->shutdown, "");
  EXPECT_FALSE(robot.set_targets({&target, 1}, 0ms)) << "still off";
  ASSERT_TRUE(robot.enable(host::kAllJoints));
  EXPECT_TRUE(robot.set_targets({&target, 1}, 0ms));
}

TEST_F(Api, SelfTestAndStatistics) {
  const auto test = robot.self_test();
  ASSERT_TRUE(test) << test.error().message;
  EXPECT_EQ(test->failed, 0);
  EXPECT_EQ(test->failed_names, "");
  EXPECT_EQ(test->image_crc, robot.identity().image_crc);
  const auto statistics = robot.board_statistics();
  ASSERT_TRUE(statistics);
  EXPECT_GE(statistics->frames, 4);
  EXPECT_EQ(statistics->bad_check, 0);
}

TEST_F(Api, TelemetryComesWithItsTicks) {
  ASSERT_TRUE(robot.subscribe(20ms, KZ_TELEMETRY_STATE | KZ_TELEMETRY_HEALTH));
  std::vector<std::uint32_t> states;
  int healths = 0;
  for (int i = 0; i < 20; ++i) {
    const auto frame = robot.next_telemetry(clock.now() + 100ms);
    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_TRUE(*frame);
    EXPECT_LT(std::abs(seconds(clock.now() - (*frame)->time)), 0.03);
    EXPECT_NEAR((*frame)->supply_volts, 9.85, 0.1);
    if ((*frame)->selection == KZ_TELEMETRY_STATE) states.push_back((*frame)->tick);
    healths += (*frame)->selection == KZ_TELEMETRY_HEALTH;
  }
  EXPECT_EQ(states.size(), 10u);
  EXPECT_EQ(healths, 10);
  for (std::size_t i = 1; i < states.size(); ++i) EXPECT_NEAR(states[i] - states[i - 1], 20, 8);
  // Far beyond the watchdog's time: the library has kept it content, so they still come.
  const auto later = robot.next_telemetry(clock.now() + 100ms);
  ASSERT_TRUE(later && *later);
  ASSERT_TRUE(robot.state()) << "requests between them are answered";
  ASSERT_TRUE(robot.subscribe(0ms, 0));
  while (*robot.next_telemetry(clock.now() + 50ms)) {
  }
  EXPECT_EQ(robot.subscribe(2ms, 1).error().fault, Fault::usage);
  EXPECT_EQ(robot.subscribe(20ms, 99).error().fault, Fault::usage);
}

TEST_F(Api, CalibrationIsStoredAndThereAfterAReset) {
  auto calibration = robot.calibration();
  ASSERT_TRUE(calibration) << calibration.error().message;
  EXPECT_EQ(calibration->source, KZ_CALIBRATION_NOMINAL);
  auto joints = calibration->joints;
  joints[host::l_elbow].centre_rad += 0.1;
  ASSERT_TRUE(robot.set_calibration(1u << host::l_elbow, joints));
  const auto stored = robot.store_calibration();
  ASSERT_TRUE(stored) << stored.error().message;
  EXPECT_GT(stored->sequence, 0);

  ASSERT_TRUE(robot.set_gains(1, {.kp_per_rad = 7}));
  ASSERT_TRUE(robot.reset());
  EXPECT_EQ(robot.identity().reset_cause, KZ_RESET_COMMAND);
  EXPECT_FALSE(robot.take_resumption()) << "this one was requested";
  calibration = robot.calibration();
  ASSERT_TRUE(calibration);
  EXPECT_NE(calibration->source, KZ_CALIBRATION_NOMINAL);
  EXPECT_EQ(calibration->sequence, stored->sequence);
  EXPECT_NEAR(calibration->joints[host::l_elbow].centre_rad, joints[host::l_elbow].centre_rad,
              1e-9);
  EXPECT_NEAR(robot.settings(0)->gains.kp_per_rad, 16, 0.01);

  joints[host::r_knee].centre_rad += 1;
  const auto far = robot.set_calibration(1u << host::r_knee, joints);
  ASSERT_FALSE(far);
  EXPECT_NE(far.error().message.find("the calibration of r_knee is too far from nominal"),
            std::string::npos)
      << far.error().message;
  ASSERT_TRUE(robot.enable(1));
  const auto armed = robot.store_calibration();
  ASSERT_FALSE(armed);
  EXPECT_NE(armed.error().message.find("while a motor is on"), std::string::npos);
}

TEST_F(Api, BenchNeedsItsUnlock) {
  const auto locked = robot.raw_drive(host::neck_pan, 0.3, 100ms);
  ASSERT_FALSE(locked);
  EXPECT_NE(locked.error().message.find("unlock"), std::string::npos) << locked.error().message;
  ASSERT_TRUE(robot.unlock(10));
  ASSERT_TRUE(robot.raw_drive(host::neck_pan, 0.3, 100ms));
  for (int i = 0; i < 4; ++i) {
    wait(50ms);
    ASSERT_TRUE(robot.state());
  }
  EXPECT_NEAR(simulation->world().joints()[host::neck_pan].angle, 0.15, 0.03);
  EXPECT_EQ(robot.raw_drive(host::neck_pan, 1.5, 100ms).error().fault, Fault::usage);
  EXPECT_EQ(robot.raw_drive(host::neck_pan, 0.5, 3s).error().fault, Fault::usage);
  EXPECT_EQ(robot.unlock(61).error().fault, Fault::usage);

  ASSERT_TRUE(robot.set_address(3, false));
  EXPECT_EQ(robot.set_address(15, false).error().fault, Fault::usage);
  ASSERT_TRUE(robot.state()) << "the old address until the next reset";
  ASSERT_TRUE(robot.start_loader());
  wait(4s);
  auto moved = host::Robot::connect(link, clock, {.address = 3});
  ASSERT_TRUE(moved) << moved.error().message;
  EXPECT_EQ(moved->identity().reset_cause, KZ_RESET_COMMAND);
}

}  // namespace
}  // namespace kaz::lockstep
