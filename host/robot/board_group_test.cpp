// Two boards that drive one robot: the real servo code twice, on one clock.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/board_group.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/link/board_testing.h"
#include "host/robot/robot.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kUpper = 0x3FF,
                        kLower = kAllJoints & ~kUpper;  // the hips' joints begin at 10

// Two test boards whose time passes together: whoever waits on one lets the other live as long.
class TwoBoards final : public Clock {
 public:
  explicit TwoBoards(const TestBoard::Options& a = {},
                     const TestBoard::Options& b = {.tick_offset = 777777us, .crystal_ppm = 80})
      : upper(a), lower(b) {}

  TestBoard upper, lower;

  Time now() const override { return std::max(upper.now(), lower.now()); }
  Result<void> sleep_until(Time t) override {
    KAZ_TRY(upper.sleep_until(std::max(t, now())));
    return lower.sleep_until(upper.now());
  }

  class Line final : public Link {
   public:
    Line(TwoBoards& both, TestBoard& board, std::string name)
        : both_(both), board_(board), name_(std::move(name)) {}
    std::string name() const override { return name_; }
    Time byte_time() const override { return board_.byte_time(); }
    Result<void> write(std::span<const std::uint8_t> bytes) override {
      KAZ_TRY(both_.sleep_until(both_.now()));
      return board_.write(bytes);
    }
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
      KAZ_TRY(both_.sleep_until(both_.now()));
      const auto count = board_.read(bytes, deadline);
      KAZ_TRY(both_.sleep_until(both_.now()));
      return count;
    }
    Result<void> reopen() override {
      ++reopened;
      if (board_.link_failure) return tl::unexpected(*board_.link_failure);
      return {};
    }
    int reopened = 0;

   private:
    TwoBoards& both_;
    TestBoard& board_;
    std::string name_;
  };
  Line upper_line{*this, upper, "port-a"}, lower_line{*this, lower, "port-b"};

  std::vector<RobotBoard> boards() { return {{&upper_line, 1, kUpper}, {&lower_line, 1, kLower}}; }
};

struct Group : ::testing::Test {
  Robot connect() {
    const auto all = both.boards();
    auto connected = Robot::connect(all, both);
    if (!connected) throw std::runtime_error(connected.error().message);
    return std::move(*connected);
  }
  void wait(Time time) { ASSERT_TRUE(robot.clock().sleep_until(both.now() + time)); }

  TwoBoards both;
  Robot robot = connect();
};

TEST_F(Group, EachJointMovesOnItsBoardAlone) {
  ASSERT_TRUE(robot.enable(kAllJoints)) << robot.enable(kAllJoints).error().message;
  const JointTarget targets[] = {{neck_pan, 0.5}, {l_knee, 0.7}};
  ASSERT_TRUE(robot.set_targets(targets, 300ms));
  wait(600ms);
  const auto posture = robot.state();
  ASSERT_TRUE(posture) << posture.error().message;
  EXPECT_NEAR(posture->angle[neck_pan], 0.5, 0.02);
  EXPECT_NEAR(posture->angle[l_knee], 0.7, 0.02);
  EXPECT_NEAR(both.upper.angles_at(both.upper.now())[l_knee], 0, 0.01) << "not on this board";
  EXPECT_NEAR(both.lower.angles_at(both.lower.now())[neck_pan], 0, 0.01);
  EXPECT_NE(posture->status & KZ_STATUS_ENABLED, 0);

  const auto targets_now = robot.read_targets();
  ASSERT_TRUE(targets_now);
  EXPECT_NEAR((*targets_now)[neck_pan], 0.5, 1e-3);
  EXPECT_NEAR((*targets_now)[l_knee], 0.7, 1e-3);
  const auto details = robot.joints(kAllJoints);
  ASSERT_TRUE(details);
  ASSERT_EQ(details->size(), static_cast<std::size_t>(KZ_JOINTS));
  EXPECT_NEAR((*details)[l_knee].angle_rad, 0.7, 0.02);

  const JointTarget head{neck_pan, 0.1};
  ASSERT_TRUE(robot.enable(kUpper));
  EXPECT_FALSE(both.lower.motors_on());
  EXPECT_TRUE(both.upper.motors_on());
  ASSERT_TRUE(robot.set_targets({&head, 1}, 100ms));
  const JointTarget knee{l_knee, 0.1};
  EXPECT_FALSE(robot.set_targets({&knee, 1}, 100ms)) << "it is off";
}

// Truth: the angles that both boards' joints had at the time that the posture says.
TEST_F(Group, APostureIsOfOneTime) {
  ASSERT_TRUE(robot.enable(kAllJoints));
  const JointTarget targets[] = {{neck_pan, 1.2}, {l_knee, 2.0}};
  ASSERT_TRUE(robot.set_targets(targets, 500ms));
  double worst = 0, uncorrected = 0;
  for (int i = 0; i < 40; ++i) {
    wait(8ms);
    const auto posture = robot.state();
    ASSERT_TRUE(posture) << posture.error().message;
    ASSERT_TRUE(both.sleep_until(both.now()));
    if (i < 3) continue;
    const double truth = both.lower.angles_at(posture->time)[l_knee];
    worst = std::max(worst, std::abs(posture->angle[l_knee] - truth));
    // What the angle of 3 ms later would be wrong by, for the scale.
    uncorrected =
        std::max(uncorrected, std::abs(both.lower.angles_at(posture->time + 3ms)[l_knee] - truth));
  }
  EXPECT_LT(worst, 0.008) << "a code of the converter is 0.006 rad here";
  EXPECT_GT(uncorrected, 0.011);
}

TEST_F(Group, SettingsReachTheBoardOfTheJoint) {
  ASSERT_TRUE(robot.set_gains(1u << neck_pan | 1u << l_knee, {.kp_per_rad = 7}));
  for (const int joint : {int{neck_pan}, int{l_knee}}) {
    const auto settings = robot.settings(joint);
    ASSERT_TRUE(settings);
    EXPECT_NEAR(settings->gains.kp_per_rad, 7, 0.01) << joint;
  }
  EXPECT_FALSE(robot.subscribe(20ms, KZ_TELEMETRY_STATE)) << "of one board only";
  ASSERT_TRUE(robot.board_statistics());
  ASSERT_TRUE(robot.self_test());
  ASSERT_TRUE(robot.calibration());
  ASSERT_TRUE(robot.health());
}

TEST_F(Group, WatchdogsOfBothAreKeptByRequestsToOne) {
  ASSERT_TRUE(robot.enable(kAllJoints));
  for (int i = 0; i < 30; ++i) {
    const JointTarget target{neck_pan, 0.01 * i};
    ASSERT_TRUE(robot.set_targets({&target, 1}, 10ms));
    ASSERT_TRUE(both.sleep_until(both.now() + 20ms));
  }
  EXPECT_FALSE(robot.take_resumption());
}

TEST_F(Group, AShutdownOfOneBoardSwitchesAllMotorsOff) {
  ASSERT_TRUE(robot.enable(kAllJoints));
  both.lower.supply_volts = 3;
  wait(300ms);
  const auto posture = robot.state();
  ASSERT_TRUE(posture);
  EXPECT_EQ(posture->status >> 8, KZ_SHUTDOWN_UNDERVOLTAGE);
  EXPECT_LT(posture->supply_volts, 4);
  ASSERT_TRUE(both.sleep_until(both.now() + 20ms));
  EXPECT_FALSE(both.upper.motors_on());
  EXPECT_FALSE(both.lower.motors_on());
  const auto health = robot.health();
  ASSERT_TRUE(health);
  EXPECT_FALSE(health->shutdown.empty());
}

TEST_F(Group, AnOffThatIsLostIsSentAgain) {
  ASSERT_TRUE(robot.enable(kAllJoints));
  int lost = 0;
  both.upper.to_board = [&](const TestBoard::Bytes& wire) {
    kz_receiver receiver;
    kz_receiver_init(&receiver);
    for (const std::uint8_t byte : wire) {
      if (kz_receive(&receiver, byte, 0) == KZ_RECEIVE_FRAME &&
          receiver.body[KZ_BODY_TYPE] == KZ_TYPE_enable && lost++ == 0)
        return TestBoard::Bytes();
    }
    return wire;
  };
  both.lower.supply_volts = 3;
  wait(300ms);
  ASSERT_TRUE(robot.state());
  ASSERT_TRUE(robot.state());
  ASSERT_TRUE(both.sleep_until(both.now() + 20ms));
  EXPECT_GT(lost, 1);
  EXPECT_FALSE(both.upper.motors_on());
}

TEST_F(Group, AnEnableThatOneBoardRefusesLeavesNoMotorOn) {
  both.lower.supply_volts = 3;
  wait(300ms);
  EXPECT_FALSE(robot.enable(kAllJoints));
  ASSERT_TRUE(both.sleep_until(both.now() + 20ms));
  EXPECT_FALSE(both.upper.motors_on());
}

TEST_F(Group, StopReachesAllEvenIfOneIsGone) {
  ASSERT_TRUE(robot.enable(kAllJoints));
  both.upper.mute = true;
  (void)robot.stop();
  EXPECT_FALSE(both.lower.motors_on());
}

// Before the lost one is waited for.
TEST_F(Group, OffReachesTheOtherBoardsWhileOneIsUnplugged) {
  ASSERT_TRUE(robot.enable(kAllJoints));
  both.upper.link_failure = Error{Fault::environment, "port-a was closed"};
  const Time pulled = both.now();
  Time off{};
  both.lower.after_tick = [&](Time start) {
    if (off == Time{} && !both.lower.motors_on()) off = start;
  };
  EXPECT_FALSE(robot.enable(0));
  EXPECT_FALSE(both.lower.motors_on());
  EXPECT_LT(off - pulled, 50ms);
}

TEST_F(Group, ABoardThatIsUnpluggedIsFoundAgain) {
  ASSERT_TRUE(robot.enable(kAllJoints));
  const JointTarget target{l_knee, 1.0};
  ASSERT_TRUE(robot.set_targets({&target, 1}, 1s));
  wait(300ms);
  const Time pulled = both.now();
  both.lower.link_failure = Error{Fault::environment, "port-b was closed"};
  both.upper.after_tick = [&](Time start) {
    if (start > pulled + 700ms) both.lower.link_failure.reset();
  };
  const auto posture = robot.state();
  ASSERT_TRUE(posture) << posture.error().message;
  const auto resumption = robot.take_resumption();
  ASSERT_TRUE(resumption);
  EXPECT_EQ(resumption->cause, Resumption::Cause::link);
  EXPECT_GT(both.lower_line.reopened, 0);
  EXPECT_EQ(both.upper_line.reopened, 0) << "only what has failed";
  EXPECT_TRUE(both.lower.motors_on());
  EXPECT_TRUE(both.upper.motors_on());
  const JointAngles held = both.lower.angles_at(both.lower.now());
  wait(200ms);
  EXPECT_NEAR(both.lower.angles_at(both.lower.now())[l_knee], held[l_knee], 0.01);
}

TEST_F(Group, ASecondBoardThatIsResetGetsItsSettingsAgain) {
  ASSERT_TRUE(robot.set_gains(kAllJoints, {.kp_per_rad = 7}));
  ASSERT_TRUE(robot.enable(kAllJoints));
  wait(100ms);
  both.lower.reset();
  wait(300ms);
  ASSERT_TRUE(robot.state());
  const auto resumption = robot.take_resumption();
  ASSERT_TRUE(resumption);
  EXPECT_EQ(resumption->cause, Resumption::Cause::reset);
  EXPECT_TRUE(both.lower.motors_on());
  const auto settings = robot.settings(l_knee);
  ASSERT_TRUE(settings);
  EXPECT_NEAR(settings->gains.kp_per_rad, 7, 0.01);
}

TEST(Boards, EachJointIsOnOne) {
  TwoBoards both;
  const auto sentence = [&](std::uint32_t upper, std::uint32_t lower) {
    const RobotBoard boards[] = {{&both.upper_line, 1, upper}, {&both.lower_line, 1, lower}};
    const auto robot = Robot::connect(boards, both);
    return robot ? std::string() : robot.error().message;
  };
  EXPECT_EQ(sentence(kUpper, kLower), "");
  EXPECT_EQ(sentence(kUpper & ~1u, kLower),
            "no board drives neck_pan: assign each joint to a board");
  EXPECT_EQ(sentence(kUpper, kLower | 2),
            "two boards drive neck_tilt: assign each joint to one board");
  EXPECT_EQ(
      sentence(kAllJoints, 0),
      "each board must have at least one joint, and only joints that Kaz has: give the joints "
      "of each board");
}

TEST(Boards, AMissingBoardIsNamed) {
  TwoBoards both;
  both.lower.mute = true;
  const auto all = both.boards();
  const auto robot = Robot::connect(all, both);
  ASSERT_FALSE(robot);
  EXPECT_NE(robot.error().message.find("port-b"), std::string::npos) << robot.error().message;
}

}  // namespace
}  // namespace kaz::host
