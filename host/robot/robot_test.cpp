// Robot against the real servo code over a simulated line.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/robot.h"

#include <gtest/gtest.h>

#include "host/robot/robot_testing.h"
#include "shared/base/angle.hpp"
#include "shared/protocol/frame.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

void wait(TestBoard& board, Time time) {
  ASSERT_TRUE(board.sleep_until(board.now() + time));
}

TEST(Robot, IdentifiesTheBoard) {
  TestBoard board;
  const Robot robot = connect_to(board);
  EXPECT_EQ(robot.identity().protocol_version, KZ_PROTOCOL_VERSION);
  EXPECT_EQ(robot.identity().joints, KZ_JOINTS);
  EXPECT_EQ(robot.statistics().timeouts, 0u);
}

TEST(Robot, MovesAJointAndSeesItThere) {
  TestBoard board;
  Robot robot = connect_to(board);
  ASSERT_TRUE(robot.enable(kAllJoints));
  EXPECT_TRUE(board.motors_on() || (wait(board, 2ms), board.motors_on()));
  const JointTarget target{neck_pan, 0.5};
  ASSERT_TRUE(robot.set_targets({&target, 1}, 150ms));
  for (int i = 0; i < 6; ++i) {
    wait(board, 50ms);
    ASSERT_TRUE(robot.state());
  }
  const auto posture = robot.state();
  ASSERT_TRUE(posture);
  // A position loop of kp 16 on a motor without load stops within a code of the potentiometer (0.19
  // degrees) and the duty step that still turns it.
  EXPECT_NEAR(posture->angle[neck_pan], 0.5, 0.006);
  EXPECT_NEAR(board.angles_at(board.now())[neck_pan], 0.5, 0.006);
  EXPECT_NEAR(posture->supply_volts, 10, 0.02);
}

TEST(Robot, EnablingDoesNotMoveAJoint) {
  TestBoard board;
  board.set_angle(neck_tilt, 20 * kDegree);
  Robot robot = connect_to(board);
  ASSERT_TRUE(robot.enable(kAllJoints));
  wait(board, 100ms);
  EXPECT_NEAR(board.angles_at(board.now())[neck_tilt], 20 * kDegree, 0.4 * kDegree);
}

TEST(Robot, RefusalsNameJointAndReason) {
  TestBoard board;
  Robot robot = connect_to(board);
  const JointTarget small{neck_tilt, 0.1}, large{neck_tilt, 100 * kDegree}, absurd{neck_tilt, 99};

  auto off = robot.set_targets({&small, 1}, 10ms);
  ASSERT_FALSE(off);
  EXPECT_NE(off.error().message.find("neck_tilt"), std::string::npos);
  EXPECT_NE(off.error().message.find("its motor is off"), std::string::npos);

  ASSERT_TRUE(robot.enable(kAllJoints));
  for (const JointTarget& target : {large, absurd}) {
    const auto beyond = robot.set_targets({&target, 1}, 10ms);
    ASSERT_FALSE(beyond);
    EXPECT_NE(beyond.error().message.find("neck_tilt"), std::string::npos);
    EXPECT_NE(beyond.error().message.find("limits of -44.99 to 74.99 degrees"), std::string::npos)
        << beyond.error().message;
  }
  const JointTarget nobody{KZ_JOINTS, 0};
  EXPECT_EQ(robot.set_targets({&nobody, 1}, 10ms).error().fault, Fault::usage);
  EXPECT_EQ(robot.set_targets({&small, 1}, 100s).error().fault, Fault::usage);
  EXPECT_EQ(robot.set_gains(1, {.kp_per_rad = 1000}).error().fault, Fault::usage);

  board.supply_volts = 3;
  wait(board, 40ms);
  const auto weak = robot.enable(kAllJoints);
  ASSERT_FALSE(weak);
  EXPECT_NE(weak.error().message.find("supply"), std::string::npos) << weak.error().message;
  EXPECT_EQ(weak.error().fault, Fault::failed) << "the robot's, not the line's";
}

// The board's unit is 0.1 rad/s, and its default ramp 6 rad/s.
TEST(Robot, KeepsTheSpeedLimitsOfTheJoints) {
  TestBoard board;
  auto robot = Robot::connect(board, board, {.max_rad_per_s = {2.05, 30, 0.01}});
  ASSERT_TRUE(robot) << robot.error().message;
  for (const auto& [joint, ramp] : {std::pair{0, 2.0}, {1, 6.0}, {2, 0.1}, {3, 6.0}})
    EXPECT_NEAR(robot->settings(joint)->limits.ramp_rad_per_s, ramp, 1e-9) << joint;
  EXPECT_TRUE(robot->set_limits(0b1, {.ramp_rad_per_s = 1}));
  EXPECT_TRUE(robot->set_limits(0b10, {.ramp_rad_per_s = 12}));
  const auto fast = robot->set_limits(0b11, {.ramp_rad_per_s = 3});
  ASSERT_FALSE(fast);
  EXPECT_EQ(fast.error().fault, Fault::usage);
  EXPECT_EQ(fast.error().message,
            "neck_pan: a ramp of 3.0 rad/s is above the joint's speed limit of 2.0 rad/s; correct "
            "the `velocity` in the robot's file, or move more slowly");
}

// Another program may have set them.
TEST(Robot, NamesTheLimitsThatAreInForce) {
  TestBoard board;
  ASSERT_TRUE(
      connect_to(board).set_limits(1u << neck_tilt, {.lower_rad = -0.1, .upper_rad = 0.12}));
  Robot robot = connect_to(board);
  ASSERT_TRUE(robot.enable(kAllJoints));
  const JointTarget target{neck_tilt, 12 * kDegree};
  const auto alone = robot.set_targets({&target, 1}, 10ms);
  ASSERT_FALSE(alone);
  EXPECT_EQ(
      alone.error().message,
      "neck_tilt was not moved: its target of 12.00 degrees lies outside the limits set on the "
      "board, -5.73 to 6.88 degrees; a reset of the board or `kaz recover --robot "
      "serial:test-port` restores the joint's own limits, -44.99 to 74.99 degrees");
  const auto cycle = robot.exchange({&target, 1}, 10ms);
  ASSERT_FALSE(cycle);
  EXPECT_EQ(cycle.error().message, alone.error().message);
}

TEST(Robot, RepeatsRequestsWhenFramesAreLostOrDamaged) {
  TestBoard board;
  Robot robot = connect_to(board);
  int count = 0;
  board.to_board = [&](TestBoard::Bytes bytes) {
    if (++count % 5 == 1) return TestBoard::Bytes{};
    if (count % 5 == 2) bytes[bytes.size() / 2] ^= 0x10;
    return bytes;
  };
  board.to_host = [&](TestBoard::Bytes bytes) {
    if (count % 5 == 3) bytes[bytes.size() / 2] ^= 0x04;
    return bytes;
  };
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(robot.state());
  // Of each five transmissions one is lost, one damaged on the way to the board, one on the way back:
  // 125 for 50.
  const LinkStatistics& statistics = robot.statistics();
  EXPECT_EQ(count, 125);
  EXPECT_EQ(statistics.retries, 75u);
  EXPECT_EQ(statistics.timeouts, 75u);
  EXPECT_EQ(statistics.bad_frames, 25u);
  EXPECT_EQ(statistics.replies, 50u + 3u);  // two to identify, one to set the watchdog
  const auto counts = robot.board_statistics();
  ASSERT_TRUE(counts);
  EXPECT_EQ(counts->bad_check, 26u);  // this request itself was damaged once
}

TEST(Robot, SaysWhenTheBoardStopsAnswering) {
  TestBoard board;
  auto connected = Robot::connect(board, board, {.reconnect = 0s});
  Robot& robot = *connected;
  ASSERT_TRUE(robot.state());
  board.mute = true;
  const Time before = board.now();
  const auto state = robot.state();
  ASSERT_FALSE(state);
  EXPECT_EQ(state.error().fault, Fault::environment);
  EXPECT_EQ(
      state.error().message,
      "the board on test-port stopped answering: no reply to `state` in 6 tries and 0.7 s; check "
      "its power and the cable");
  // Time-outs of 20, 40, 80, 160, 200 and 200 ms.
  EXPECT_NEAR(seconds(board.now() - before), 0.7, 0.002);
  EXPECT_NE(robot.recent_frames().find("out  state"), std::string::npos);
}

TEST(Robot, IgnoresLateAndDoubledReplies) {
  TestBoard board;
  Robot robot = connect_to(board);
  board.to_host = [](TestBoard::Bytes frame) {
    TestBoard::Bytes twice = frame;
    twice.insert(twice.end(), frame.begin(), frame.end());
    return twice;
  };
  std::uint32_t last_tick = 0;
  for (int i = 0; i < 20; ++i) {
    const auto state = robot.state();
    ASSERT_TRUE(state);
    EXPECT_GT(state->tick, last_tick);  // an old reply would repeat an old tick
    last_tick = state->tick;
  }
  EXPECT_GE(robot.statistics().ignored, 19u);
  EXPECT_EQ(robot.statistics().retries, 0u);
}

TEST(Robot, ExchangeIsOneRoundTrip) {
  TestBoard board;
  Robot robot = connect_to(board);
  ASSERT_TRUE(robot.enable(kAllJoints));
  const JointTarget targets[] = {{neck_pan, 0.1}, {neck_tilt, 0.2}};
  for (int i = 0; i < 100; ++i) {
    const Time before = board.now();
    ASSERT_TRUE(robot.exchange(targets, 12ms));
    // 19 bytes out, a gap of a tick, then at most two ticks and 53 bytes back.
    EXPECT_LT(seconds(board.now() - before), 0.0100);
    wait(board, Time(1234567));
  }
  EXPECT_EQ(robot.statistics().refused, 0u);
  EXPECT_EQ(robot.statistics().retries, 0u);
}

TEST(Robot, WaitsForABusyBoard) {
  TestBoard board;
  Robot robot = connect_to(board);
  // A state request that nobody waits for, so that the board is sending when the next request
  // comes.
  std::uint8_t body[] = {KZ_ADDRESS_DEFAULT, KZ_TYPE_state, 77};
  std::uint8_t wire[KZ_FRAME_MAX];
  const std::uint8_t length = kz_frame_encode(body, sizeof body, wire);
  ASSERT_TRUE(board.write({wire, length}));
  wait(board, 3ms);
  ASSERT_TRUE(robot.heartbeat());
  EXPECT_EQ(robot.statistics().timeouts, 0u);
}

TEST(Robot, ReportsMotorsThatWentOff) {
  TestBoard board;
  auto connected = Robot::connect(board, board, {.reaction = Reaction::limp, .reconnect = 0s});
  Robot& robot = *connected;
  ASSERT_TRUE(robot.enable(kAllJoints));
  wait(board, 100ms);  // longer than the link watchdog's 90 ms
  EXPECT_FALSE(board.motors_on());
  const auto state = robot.state();
  ASSERT_TRUE(state);
  const auto sentence = fault_sentence(state->status);
  ASSERT_TRUE(sentence);
  EXPECT_NE(sentence->find(" motors went off: "), std::string::npos) << *sentence;
  EXPECT_NE(fault_sentence(KZ_SHUTDOWN_STOP << 8 | KZ_STATUS_ENABLED)
                ->find("not all motors confirm that they are off: "),
            std::string::npos);
  EXPECT_NE(sentence->find("no request came for too long"), std::string::npos);
  EXPECT_FALSE(fault_sentence(KZ_STATUS_ENABLED | KZ_STATUS_MOVING));
  EXPECT_EQ(shutdown_fault(state->status), Fault::environment) << "nothing reached the board";
  EXPECT_EQ(shutdown_fault(KZ_SHUTDOWN_STALL << 8), Fault::failed);
}

TEST(Robot, DisablesAllEvenWhenInterrupted) {
  TestBoard board;
  Robot robot = connect_to(board);
  ASSERT_TRUE(robot.enable(kAllJoints));
  wait(board, 5ms);
  EXPECT_TRUE(board.motors_on());
  EXPECT_TRUE(robot.disable_all());
  wait(board, 5ms);
  EXPECT_FALSE(board.motors_on());

  board.link_failure = Error{Fault::environment, "gone"};
  const auto off = robot.disable_all();  // must not throw
  ASSERT_FALSE(off);
  EXPECT_EQ(off.error().message,
            "no reply confirms that the motors on test-port are off (gone): cut their power");
  EXPECT_EQ(robot.state().error().message, "gone; the board was not found again within 3.0 s");
}

// A board that does not switch the motor of the neck off, as its replies say.
TestBoard::Bytes says_on(const TestBoard::Bytes& wire) {
  TestBoard::Bytes all;
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  for (const std::uint8_t byte : wire) {
    if (kz_receive(&receiver, byte, 0) != KZ_RECEIVE_FRAME) continue;
    std::vector<std::uint8_t> body(receiver.body, receiver.body + receiver.length);
    const std::uint8_t type = body[KZ_BODY_TYPE];
    if (type == KZ_TYPE_enable_reply || type == KZ_TYPE_stop_reply)
      body[KZ_HEADER_SIZE + 5] |= KZ_STATUS_ENABLED;     // behind the tick
    if (type == KZ_TYPE_enable_reply) body.back() |= 1;  // of the mask, joint 0
    std::array<std::uint8_t, KZ_FRAME_MAX> frame{};
    const auto length =
        kz_frame_encode(body.data(), static_cast<std::uint8_t>(body.size()), frame.data());
    all.insert(all.end(), frame.begin(), frame.begin() + length);
  }
  return all;
}

TEST(Robot, OffIsWhatTheReplyConfirms) {
  TestBoard board;
  Robot robot = connect_to(board);
  ASSERT_TRUE(robot.enable(kAllJoints));
  board.to_host = says_on;
  const auto off = robot.disable_all();
  ASSERT_FALSE(off);
  EXPECT_EQ(off.error().fault, Fault::environment);
  EXPECT_EQ(
      off.error().message,
      "no reply confirms that the motors on test-port are off (still on: neck_pan): cut their "
      "power");
  const auto stopped = robot.stop();
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().message,
            "the stop request failed: motors are still on; cut their power");
  const auto enabled = robot.enable(0b10);
  ASSERT_FALSE(enabled);
  EXPECT_NE(enabled.error().message.find("as requested: still on: neck_pan; cut their power"),
            std::string::npos)
      << enabled.error().message;
  board.to_host = nullptr;
  EXPECT_TRUE(robot.stop());
  EXPECT_TRUE(robot.disable_all());
}

TEST(Robot, PostureAtInterpolates) {
  TestBoard board;
  Robot robot = connect_to(board);
  ASSERT_TRUE(robot.enable(kAllJoints));
  const JointTarget target{neck_pan, 1.0};
  ASSERT_TRUE(robot.set_targets({&target, 1}, 1s));  // 1 rad/s
  std::vector<Time> moments;
  for (int i = 0; i < 100; ++i) {
    wait(board, 10ms);
    ASSERT_TRUE(robot.state());
    moments.push_back(board.now() - 20ms);
  }
  for (const Time t : moments) {
    const auto posture = robot.posture_at(t);
    if (t < moments.front() + 20ms) continue;
    ASSERT_TRUE(posture);
    EXPECT_EQ(posture->time, t);
    // A code of the potentiometer (3.2 mrad) and the error in time (1 mrad a millisecond).
    EXPECT_NEAR(posture->angle[neck_pan], board.angles_at(t)[neck_pan], 0.0032 + 0.001);
  }
  EXPECT_FALSE(robot.posture_at(board.now() + 1ms));
  EXPECT_FALSE(robot.posture_at(board.now() - 6s));
}

// A code of the gyro is 0.977 degrees/s, one of the accelerometer 0.0157 g; each stands
// for its middle.
TEST(Robot, ReadsGyroAndAccelerometerToo) {
  TestBoard board;
  Robot robot = connect_to(board);
  EXPECT_FALSE(robot.sense_inertial().value()) << "all three inputs grounded";
  EXPECT_FALSE(robot.state()->inertial);
  board.inertial = {612, 448, 511};
  EXPECT_TRUE(robot.sense_inertial().value());
  ASSERT_TRUE(robot.enable(kAllJoints));
  const JointTarget target[] = {{neck_pan, 0.01}};
  for (const auto& posture :
       {robot.state(), robot.exchange(target, std::chrono::milliseconds(12))}) {
    ASSERT_TRUE(posture) << posture.error().message;
    ASSERT_TRUE(posture->inertial);
    EXPECT_NEAR(posture->inertial->yaw_rate_rad_per_s * 180 / 3.14159265, 100.5 * 0.9765625, 1e-3);
    EXPECT_NEAR(posture->inertial->forward_m_per_s2, -63.5 / 1024 / 0.0624 * 9.80665, 1e-6);
    EXPECT_NEAR(posture->inertial->left_m_per_s2, -0.5 / 1024 / 0.0624 * 9.80665, 1e-6);
    EXPECT_GE(posture->inertial->time, posture->time);
  }
}

}  // namespace
}  // namespace kaz::host
