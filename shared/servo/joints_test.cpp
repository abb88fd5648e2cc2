// Ramps and the position loop: timing, gains, saturation, signs; and the loop around a motor.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/joints.h"
#include "shared/servo/joint_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/servo/board_testing.h"

namespace kaz::test {
namespace {

constexpr int kNeckPan = 0, kRShPitch = 6, kLHand = 5;

// A ramp that starts with the next tick.
void go(TestBoard& board, int joint, int angle, int duration_ms) {
  board.servo.joint[joint].target = static_cast<s16>(angle);
  board.servo.joint[joint].target_ms = static_cast<u16>(duration_ms);
  board.servo.fresh_targets = 1u << joint;
  kz_joints_start_ramps(&board.servo);
}

// Ticks during which the host says now and then that it is there.
void run(TestBoard& board, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    if (i % 50 == 0) board.send(KZ_TYPE_heartbeat, ++board.sequence, {0, 0});
    board.tick();
  }
}

TEST(Ramp, IsStraightAndEndsInTimeOnTheTarget) {
  TestBoard board;
  ASSERT_EQ(board.enable(1), 0);
  ASSERT_EQ(board.gains(1, 0, 0), 0);  // it never moves: it would count as stalled
  for (const int target : {5000, -1234, 7, 15707}) {
    for (const int duration : {1000, 333, 700}) {
      const kz_joint& joint = board.servo.joint[kNeckPan];
      const int start = joint.command;
      go(board, kNeckPan, target, duration);
      for (int i = 1; i <= duration; ++i) {
        run(board, 1);
        const double line = start + double(target - start) * i / duration;
        ASSERT_NEAR(joint.command, line, 1.0) << "to " << target << " at " << i;
      }
      EXPECT_EQ(joint.command, target);
      EXPECT_EQ(joint.ramp_left, 0);
      go(board, kNeckPan, 0, 400);
      run(board, 400);
      ASSERT_EQ(joint.command, 0);
    }
  }
}

TEST(Ramp, TheJointsRampIsItsHighestSpeed) {
  TestBoard board;
  ASSERT_EQ(board.enable(1), 0);
  ASSERT_EQ(board.gains(1, 0, 0), 0);
  const kz_joint& joint = board.servo.joint[kNeckPan];
  const s16 here = joint.angle;
  for (const int duration : {0, 1, 83}) {
    ASSERT_EQ(joint.command, here);
    go(board, kNeckPan, static_cast<s16>(here + 5000), duration);
    EXPECT_EQ(joint.ramp_left, 84);  // 5000 / 60 = 83.3
    int before = here;
    for (int i = 0; i < 84; ++i) {
      run(board, 1);
      ASSERT_LE(joint.command - before, 60);
      before = joint.command;
    }
    EXPECT_EQ(joint.command, here + 5000);
    go(board, kNeckPan, here, 100);
    run(board, 100);
  }
}

TEST(Ramp, ANewTargetStartsFromWhereTheRampIs) {
  TestBoard board;
  ASSERT_EQ(board.enable(1), 0);
  const s16 here = board.servo.joint[kNeckPan].angle;
  go(board, kNeckPan, static_cast<s16>(here + 4000), 100);
  run(board, 50);
  ASSERT_EQ(board.servo.joint[kNeckPan].command, here + 2000);
  go(board, kNeckPan, here, 100);
  board.tick();
  EXPECT_EQ(board.servo.joint[kNeckPan].command, here + 1980);
  EXPECT_EQ(board.status() & KZ_STATUS_MOVING, KZ_STATUS_MOVING);
  run(board, 100);
  EXPECT_EQ(board.status(), KZ_STATUS_ENABLED);
}

TEST(Ramp, TheWidestWayDoesNotOverflow) {
  TestBoard board;
  kz_joint& joint = board.servo.joint[kNeckPan];
  joint.ramp_limit = 1;
  joint.command = -32768;
  go(board, kNeckPan, 32767, 0);
  EXPECT_EQ(joint.ramp_left, 65535);
  EXPECT_EQ(joint.ramp_whole, 1);
  joint.ramp_limit = 65535;
  go(board, kNeckPan, 32767, 65535);
  EXPECT_EQ(joint.ramp_left, 65535);
  go(board, kNeckPan, 32767, 0);
  EXPECT_EQ(joint.ramp_left, 1);
  EXPECT_EQ(joint.ramp_whole, 65535);
}

TEST(PositionLoop, DutyIsGainTimesError) {
  TestBoard board;
  ASSERT_EQ(board.enable(1), 0);
  const s16 here = board.servo.joint[kNeckPan].angle;
  // 0.01 rad at 16 /rad: 0.16 of 255, 40.8.
  ASSERT_EQ(board.target(kNeckPan, static_cast<s16>(here + 100), 0), 0);
  board.ticks(20);
  EXPECT_EQ(board.output.pw[0], 41);
  EXPECT_EQ(board.output.p3 & 1, 1);
  ASSERT_EQ(board.target(kNeckPan, static_cast<s16>(here - 100), 0), 0);
  board.ticks(20);
  EXPECT_EQ(board.output.pw[0], 41);
  EXPECT_EQ(board.output.p3 & 1, 0);
}

TEST(PositionLoop, AMirroredServoTurnsTheOtherWay) {
  TestBoard board;
  ASSERT_EQ(board.enable(1u << kRShPitch), 0);
  const s16 here = KZ_DECIDEG(-500) - 16;  // mirrored: half a code to the other side
  EXPECT_EQ(board.servo.joint[kRShPitch].angle, here);
  ASSERT_EQ(board.target(kRShPitch, static_cast<s16>(here + 100), 0), 0);
  board.ticks(20);
  EXPECT_EQ(board.output.pw[5], 41);
  EXPECT_EQ(board.output.p3 >> 6 & 1, 0);  // backward shaft, forward joint
}

TEST(PositionLoop, HandsAreOnTheTimersAndGiveWay) {
  TestBoard board;
  ASSERT_EQ(board.enable(1u << kLHand), 0);
  const s16 here = board.servo.joint[kLHand].angle;
  ASSERT_EQ(board.target(kLHand, static_cast<s16>(here + 1000), 0), 0);
  board.ticks(50);
  EXPECT_NEAR(board.output.tmo[0], 20.4, 1.0);  // 0.1 rad at 0.8 /rad: 0.08 of 255
}

TEST(PositionLoop, DutySaturatesAtFull) {
  TestBoard board;
  ASSERT_EQ(board.enable(1), 0);
  for (const u16 kp : {5120, KZ_KP_MAX}) {
    ASSERT_EQ(board.gains(1, kp, 0), 0);
    ASSERT_EQ(board.target(kNeckPan, 15707, 0), 0);
    board.ticks(40);
    EXPECT_EQ(board.output.pw[0], 255);
    EXPECT_EQ(board.output.p3 & 1, 1);
    ASSERT_EQ(board.target(kNeckPan, -15707, 0), 0);
    board.ticks(60);
    EXPECT_EQ(board.output.pw[0], 255);
    EXPECT_EQ(board.output.p3 & 1, 0);
  }
}

TEST(PositionLoop, DampingIsGainTimesSpeed) {
  TestBoard board;
  board.set_pot(kNeckPan, 300);
  board.tick();
  ASSERT_EQ(board.enable(1), 0);
  ASSERT_EQ(board.gains(1, 0, 410), 0);  // 0.1 s/rad
  for (int i = 0; i < 150; ++i) {
    board.set_pot(kNeckPan, static_cast<u16>(300 + i));
    run(board, 1);
  }
  // One code a millisecond: 190 / 1024 degrees in 1 ms = 3.238 rad/s; times 0.1 of 255 counts.
  EXPECT_NEAR(board.output.pw[0], 82.7, 1.0);
  EXPECT_EQ(board.output.p3 & 1, 0);  // against the motion
}

TEST(PositionLoop, TheRateFilterSettlesIn8Ms) {
  // Step of the speed: after n ticks 1 - (7/8)^n of it is seen.
  TestBoard board;
  board.ticks(2);
  for (int i = 1; i <= 8; ++i) {
    board.set_pot(kNeckPan, static_cast<u16>(512 + i));
    board.tick();
  }
  const double speed = KZ_POT_HALF_SPAN / 512.0 * 64;  // 1/64 of 100 urad/ms
  EXPECT_NEAR(board.servo.joint[kNeckPan].rate, speed * (1 - std::pow(7.0 / 8, 8)), 32 + 8);
}

TEST(Gains, AreScaledWithoutOverflow) {
  EXPECT_EQ(kz_scaled_kp(0), 0);
  EXPECT_NEAR(kz_scaled_kp(65535), 26738, 1);  // * 0.408 = 26738.3
  EXPECT_EQ(kz_scaled_kp(5120), 2089);         // 2088.96
  EXPECT_EQ(kz_scaled_kd(65535), 13056);       // * 0.19921875 = 13055.8
  EXPECT_EQ(kz_scaled_kd(614), 122);           // 122.3
}

// A gear motor with a link: kaz-model, section 3. One millisecond, back-EMF implicit.
struct Motor {
  double angle = 0, speed = 0;
  void step(double duty) {
    constexpr double dt = 0.001, stall = 2.16, damping = 0.1885, friction = 0.05, inertia = 2e-3;
    double next = (speed + dt / inertia * stall * duty) / (1 + dt / inertia * damping);
    const double brake = dt / inertia * friction;
    next = std::abs(next) < brake ? 0 : next - std::copysign(brake, next);
    speed = next;
    angle += dt * speed;
  }
};

TEST(ClosedLoop, TheMotorGoesToTheTargetAndStays) {
  TestBoard board;
  ASSERT_EQ(board.heartbeat(100), 0);
  ASSERT_EQ(board.enable(1), 0);
  ASSERT_EQ(board.target(kNeckPan, 8000, 300), 0);
  Motor motor;
  double highest = 0;
  for (int ms = 0; ms < 800; ++ms) {
    const double code = 512 + motor.angle * 180 / std::numbers::pi * KZ_POT_CODES / 190;
    board.set_pot(kNeckPan, static_cast<u16>(std::floor(code)));
    board.tick();
    const double sign = (board.output.p3 & 1) ? 1 : -1;
    motor.step(sign * board.output.pw[0] / 256.0);
    highest = std::max(highest, motor.angle);
    // Friction over stiffness (1.2 mrad), half a code (1.6) and the floor of the converter (3.2).
    if (ms > 500) {
      ASSERT_NEAR(motor.angle, 0.8, 0.008) << ms;
    }
  }
  EXPECT_LT(highest, 0.8 + 0.02);
}

}  // namespace
}  // namespace kaz::test
