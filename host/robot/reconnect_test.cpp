// What Robot does when the link is lost: cable, reset, watchdog, for short and for good.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "host/robot/robot.h"
#include "host/robot/robot_testing.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

struct Reconnect : ::testing::Test {
  void wait(Time time) { ASSERT_TRUE(board.sleep_until(board.now() + time)); }

  // neck_pan moves to 1 rad and is stopped in between.
  void begin_moving() {
    ASSERT_TRUE(robot.enable(kAllJoints));
    const JointTarget target{neck_pan, 1.0};
    ASSERT_TRUE(robot.set_targets({&target, 1}, 1s));
    for (int i = 0; i < 10; ++i) {
      wait(20ms);
      ASSERT_TRUE(robot.state());
    }
  }
  // Nothing moves from now on but what a loop and a potentiometer's code make of holding.
  void expect_still(const JointAngles& before) {
    for (int i = 0; i < 10; ++i) {
      wait(20ms);
      ASSERT_TRUE(robot.state());
      const JointAngles now = board.angles_at(board.now());
      for (std::size_t j = 0; j < now.size(); ++j) EXPECT_NEAR(now[j], before[j], 0.01) << j;
    }
  }
  void expect_resumed(Resumption::Cause cause) {
    const auto resumption = robot.take_resumption();
    ASSERT_TRUE(resumption);
    EXPECT_EQ(resumption->cause, cause);
    EXPECT_GE(resumption->resumed, resumption->lost);
    EXPECT_FALSE(robot.take_resumption());
  }

  TestBoard board;
  Robot robot = connect_to(board);
};

TEST_F(Reconnect, BoardHoldsWithin100msAndGoesOnHolding) {
  begin_moving();
  wait(100ms);  // no requests
  const JointAngles held = board.angles_at(board.now());
  EXPECT_TRUE(board.motors_on());
  EXPECT_GT(held[neck_pan], 0.1);
  EXPECT_LT(held[neck_pan], 0.4);
  wait(500ms);
  EXPECT_NEAR(board.angles_at(board.now())[neck_pan], held[neck_pan], 0.03);

  const auto posture = robot.state();
  ASSERT_TRUE(posture) << posture.error().message;
  EXPECT_EQ(posture->status & KZ_STATUS_HOLDING, 0);
  EXPECT_NE(posture->status & KZ_STATUS_ENABLED, 0);
  expect_resumed(Resumption::Cause::watchdog);
  const auto targets = robot.read_targets();
  ASSERT_TRUE(targets);
  EXPECT_NEAR((*targets)[neck_pan], posture->angle[neck_pan], 0.01);
  expect_still(board.angles_at(board.now()));
}

TEST_F(Reconnect, CableIsPulledAndPluggedInAgain) {
  begin_moving();
  const Time pulled = board.now();
  board.mute = true;
  board.after_tick = [&](Time start) {
    if (start > pulled + 1500ms) board.mute = false;
  };
  const JointTarget target{neck_pan, 1.0};
  const auto posture = robot.exchange({&target, 1}, 10ms);
  ASSERT_TRUE(posture) << posture.error().message;
  EXPECT_LT(board.now() - pulled, 2s);
  EXPECT_TRUE(board.motors_on());
  EXPECT_LT(posture->angle[neck_pan], 0.5) << "the target of before was not sent";
  expect_resumed(Resumption::Cause::link);
  expect_still(board.angles_at(board.now()));

  ASSERT_TRUE(robot.set_targets({&target, 1}, 100ms)) << "and on it goes";
}

TEST_F(Reconnect, PortGoesAndComesBack) {
  begin_moving();
  const Time pulled = board.now();
  board.link_failure = Error{Fault::environment, "port test-port was closed"};
  board.after_tick = [&](Time start) {
    if (start > pulled + 700ms) board.link_failure.reset();
  };
  ASSERT_TRUE(robot.state());
  EXPECT_GT(board.now() - pulled, 700ms);
  expect_resumed(Resumption::Cause::link);
  expect_still(board.angles_at(board.now()));
}

TEST_F(Reconnect, ResetBoardGetsItsSettingsAgain) {
  const Gains soft{.kp_per_rad = 5, .kd_s_per_rad = 0.1, .dead_band_rad = 0.01, .friction = 0.1};
  ASSERT_TRUE(robot.set_gains(kAllJoints, {.kp_per_rad = 10}));
  ASSERT_TRUE(robot.set_gains(1u << neck_tilt | 1u << l_knee, soft));
  ASSERT_TRUE(robot.set_limits(1u << neck_pan, {.ramp_rad_per_s = 2, .upper_rad = 1.2}));
  begin_moving();
  board.reset();
  wait(20ms);
  EXPECT_FALSE(board.motors_on());
  const JointAngles there = board.angles_at(board.now());

  const JointTarget target{neck_pan, 1.0};
  const auto refused = robot.set_targets({&target, 1}, 10ms);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("the board was reset during `targets`"), std::string::npos)
      << refused.error().message;
  EXPECT_EQ(refused.error().fault, Fault::environment);
  expect_resumed(Resumption::Cause::reset);
  EXPECT_TRUE(board.motors_on());
  expect_still(there);

  EXPECT_NEAR(robot.settings(neck_tilt)->gains.kp_per_rad, 5, 0.1);
  EXPECT_NEAR(robot.settings(neck_tilt)->gains.dead_band_rad, 0.01, 1e-4);
  EXPECT_NEAR(robot.settings(l_knee)->gains.kp_per_rad, 5, 0.1);
  EXPECT_NEAR(robot.settings(l_elbow)->gains.kp_per_rad, 10, 0.1);
  EXPECT_NEAR(robot.settings(neck_pan)->limits.upper_rad, 1.2, 1e-3);
  EXPECT_NEAR(robot.settings(neck_pan)->limits.ramp_rad_per_s, 2, 1e-6);
  wait(95ms);
  ASSERT_TRUE(robot.state());
  expect_resumed(Resumption::Cause::watchdog);  // which is 90 ms again, not the board's 200
}

// The motors' supply often comes later than the chip's.
TEST_F(Reconnect, ResetBoardWhoseSupplyIsLateIsTriedAgain) {
  begin_moving();
  const Time before = board.now();
  board.supply_volts = 3;
  board.reset();
  board.after_tick = [&](Time start) {
    if (start > before + 500ms) board.supply_volts.reset();
  };
  const auto posture = robot.state();
  ASSERT_TRUE(posture) << posture.error().message;
  EXPECT_GT(board.now() - before, 500ms);
  expect_resumed(Resumption::Cause::reset);
}

TEST_F(Reconnect, ResetDuringAnOutageIsNoticed) {
  begin_moving();
  const Time pulled = board.now();
  board.mute = true;
  bool was_reset = false;
  board.after_tick = [&](Time start) {
    if (start > pulled + 100ms && !was_reset) {
      was_reset = true;
      board.reset();
    }
    if (start > pulled + 150ms) board.mute = false;
  };
  ASSERT_TRUE(robot.state());
  expect_resumed(Resumption::Cause::reset);
  EXPECT_TRUE(board.motors_on() || (wait(5ms), board.motors_on()));
}

TEST_F(Reconnect, OtherShutdownsAreNotClearedByThemselves) {
  begin_moving();
  board.supply_volts = 3;
  wait(60ms);
  EXPECT_FALSE(board.motors_on());
  board.supply_volts.reset();
  wait(60ms);
  const auto posture = robot.state();
  ASSERT_TRUE(posture);
  EXPECT_FALSE(robot.take_resumption());
  ASSERT_TRUE(fault_sentence(posture->status));
  wait(200ms);
  EXPECT_FALSE(board.motors_on());
}

TEST_F(Reconnect, GivesUpAfterItsTimeAndLeavesTheFrames) {
  const auto path =
      std::filesystem::temp_directory_path() / ("kaz-frames-test-" + std::to_string(::getpid()));
  auto connected = Robot::connect(board, board, {.reconnect = 500ms, .frames_path = path.string()});
  ASSERT_TRUE(connected);
  ASSERT_TRUE(connected->state());
  board.mute = true;
  const Time before = board.now();
  const auto state = connected->state();
  ASSERT_FALSE(state);
  EXPECT_LT(board.now() - before, 1500ms);
  EXPECT_NE(state.error().message.find("stopped answering"), std::string::npos);
  EXPECT_NE(state.error().message.find("not found again within 0."), std::string::npos)
      << state.error().message;
  EXPECT_NE(state.error().message.find("; the last frames are in " + path.string()),
            std::string::npos);
  std::ostringstream frames;
  frames << std::ifstream(path).rdbuf();
  EXPECT_NE(frames.str().find("state_reply"), std::string::npos);
  std::filesystem::remove(path);
}

// One line before the search, one after it, whoever waits beside the robot wants to know at once.
TEST_F(Reconnect, ALossIsReportedOnceBeforeTheSearch) {
  std::vector<Loss> losses;
  std::vector<Resumption> resumptions;
  auto connected =
      Robot::connect(board, board,
                     {.reconnect = 2s,
                      .on_lost = [&](const Loss& one) { losses.push_back(one); },
                      .on_resumed = [&](const Resumption& one) { resumptions.push_back(one); }});
  ASSERT_TRUE(connected);
  for (std::size_t time = 1; time <= 3; ++time) {
    const Time pulled = board.now();
    board.link_failure = Error{Fault::environment, "port test-port was closed"};
    board.after_tick = [&, pulled, time](Time start) {
      if (!board.link_failure || start < pulled + 300ms) return;
      EXPECT_EQ(losses.size(), time) << "not only when it is back";
      board.link_failure.reset();
    };
    ASSERT_TRUE(connected->state());
    ASSERT_EQ(losses.size(), time);
    EXPECT_EQ(losses.back().why, "port test-port was closed");
    EXPECT_EQ(losses.back().at_most, 2s);
    EXPECT_LT(losses.back().at, pulled + 50ms);
    ASSERT_EQ(resumptions.size(), time);
    EXPECT_TRUE(resumptions.back().reported);
  }
  // A board that answers at once was not sought.
  ASSERT_TRUE(connected->enable(kAllJoints));
  wait(150ms);
  ASSERT_TRUE(connected->state());
  EXPECT_EQ(losses.size(), 3u);
  ASSERT_EQ(resumptions.size(), 4u);
  EXPECT_FALSE(resumptions.back().reported);
  // One that does not come back is reported all the same, and the error says for how long it was sought.
  board.mute = true;
  const auto state = connected->state();
  ASSERT_FALSE(state);
  EXPECT_EQ(losses.size(), 4u);
  EXPECT_NE(losses.back().why.find("stopped answering"), std::string::npos) << losses.back().why;
  EXPECT_EQ(resumptions.size(), 4u);
}

TEST_F(Reconnect, SleepingOnItsClockKeepsTheWatchdogContent) {
  begin_moving();
  ASSERT_TRUE(robot.clock().sleep_until(board.now() + 2s));
  ASSERT_TRUE(robot.state());
  EXPECT_FALSE(robot.take_resumption());
  EXPECT_TRUE(board.motors_on());
  EXPECT_NEAR(board.angles_at(board.now())[neck_pan], 1.0, 0.01);
}

// Whoever leaves the board's watchdog as it is (200 ms, limp) gets heartbeats for that.
TEST_F(Reconnect, HeartbeatsSuitTheBoardsOwnWatchdogToo) {
  TestBoard other;
  auto plain = Robot::connect(other, other, {.watchdog = 0ms, .reconnect = 0s});
  ASSERT_TRUE(plain) << plain.error().message;
  ASSERT_TRUE(plain->enable(kAllJoints));
  ASSERT_TRUE(plain->clock().sleep_until(other.now() + 2s));
  EXPECT_TRUE(other.motors_on());
  ASSERT_TRUE(other.sleep_until(other.now() + 300ms));
  EXPECT_FALSE(other.motors_on());
}

}  // namespace
}  // namespace kaz::host
