// Protection of the motors: what must switch them off, and what must not.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/protection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "shared/servo/board_testing.h"
#include "shared/servo/joint_loop.h"
#include "shared/servo/joints.h"
#include "shared/servo/status.h"

namespace kaz::test {
namespace {

constexpr int kKnee = 12;  // not mirrored, 0.67 rad at mid-scale
constexpr u32 kOnlyKnee = 1u << kKnee;

class Protection : public testing::Test {
 protected:
  // Enables the knee with a target that demands `share` of full duty; gain in units of 1/256 per rad.
  void push(double share) {
    ASSERT_EQ(board.heartbeat(100), 0);
    ASSERT_EQ(board.enable(kOnlyKnee), 0);
    ASSERT_EQ(board.gains(kOnlyKnee, 2560, 0), 0);  // 10 /rad
    kz_joint& joint = board.servo.joint[kKnee];
    joint.command = joint.target = static_cast<s16>(joint.angle + std::lround(share * 1000));
  }
  // Milliseconds until the motors go off, at most `max_ms`; the host says now and then that it is there.
  int until_off(int max_ms) {
    for (int ms = 0; ms < max_ms; ++ms) {
      if (ms % 500 == 0) board.send(KZ_TYPE_heartbeat, ++board.sequence, {0, 0});
      if (!board.drivers_on()) return ms;
      board.tick();
    }
    return max_ms;
  }
  kz_joint& joint() { return board.servo.joint[kKnee]; }

  TestBoard board;
};

TEST_F(Protection, AStalledMotorIsSwitchedOffAfterASecond) {
  push(1.0);
  EXPECT_NEAR(until_off(5000), 1000, 60);
  EXPECT_EQ(board.servo.shutdown, KZ_SHUTDOWN_STALL);
  EXPECT_EQ(board.servo.shutdown_detail, kKnee);
  board.ticks(20);
  EXPECT_EQ(board.clear(), 0);  // it is not stalled any more: it is off
}

TEST_F(Protection, StallIsReportedBeforeItSwitchesOff) {
  push(1.0);
  board.ticks(500);
  EXPECT_TRUE(kz_joint_flags(&board.servo.joint[kKnee], 0) & KZ_JOINT_STALLED);
  EXPECT_TRUE(board.drivers_on());
  EXPECT_NEAR(kz_joint_load(&joint()), 252, 1);
}

TEST_F(Protection, HighLoadForLessThanASecondIsNoStall) {
  for (int i = 0; i < 3; ++i) {
    push(1.0);
    board.ticks(900);
    joint().command = joint().angle;
    EXPECT_EQ(until_off(1000), 1000) << i;
  }
}

TEST_F(Protection, AMotorThatMovesUnderHighLoadIsNotStalled) {
  push(1.0);
  for (int ms = 0; ms < 1500; ++ms) {
    if (ms % 500 == 0) board.send(KZ_TYPE_heartbeat, ++board.sequence, {0, 0});
    board.set_pot(kKnee, static_cast<u16>(512 + ms / 25));  // 0.13 rad/s
    joint().command = static_cast<s16>(joint().angle + 1000);
    board.tick();
    ASSERT_TRUE(board.drivers_on()) << ms;
  }
}

TEST_F(Protection, AMotorThatMovesBackwardsUnderHighLoadIsNotStalled) {
  push(-1.0);
  for (int ms = 0; ms < 1500; ++ms) {
    if (ms % 500 == 0) board.send(KZ_TYPE_heartbeat, ++board.sequence, {0, 0});
    board.set_pot(kKnee, static_cast<u16>(512 - ms / 25));
    joint().command = static_cast<s16>(joint().angle - 1000);
    board.tick();
    ASSERT_TRUE(board.drivers_on()) << ms;
  }
}

// Four codes of the potentiometer are 0.013 rad, less than half of what counts as motion.
TEST_F(Protection, AStalledMotorThatCreepsEitherWayIsStillStalled) {
  for (const int direction : {1, -1}) {
    board = TestBoard();
    push(1.0);
    int ms = 0;
    for (; ms < 2000 && board.drivers_on(); ++ms) {
      if (ms % 500 == 0) board.send(KZ_TYPE_heartbeat, ++board.sequence, {0, 0});
      board.set_pot(kKnee, static_cast<u16>(512 + direction * (ms / 250)));
      joint().command = static_cast<s16>(joint().angle + 1000);
      board.tick();
    }
    EXPECT_NEAR(ms, 1000, 60) << direction;
    EXPECT_EQ(board.servo.shutdown, KZ_SHUTDOWN_STALL) << direction;
  }
}

// A count goes up and down by one in 16 ms: after 900 ms of load and 96 without, 200 more are enough.
TEST_F(Protection, ShortReliefDoesNotClearTheStallCounter) {
  push(1.0);
  board.ticks(900);
  joint().command = joint().angle;
  board.ticks(96);
  push(1.0);
  EXPECT_NEAR(until_off(1000), 200, 50);
  EXPECT_EQ(board.servo.shutdown, KZ_SHUTDOWN_STALL);
}

// load^2 with one time constant against the load that is allowed for ever.
double seconds_to_heat(double load) {
  const double tau = 0.016 * 8192, limit = 89.0 / 255;
  return -tau * std::log(1 - limit * limit / (load * load));
}

TEST_F(Protection, HeatFollowsTheModel) {
  for (const double share : {0.4, 0.5, 0.65}) {
    board = TestBoard();
    push(share);
    const double expected = seconds_to_heat(share * 252 / 255);
    EXPECT_NEAR(until_off(300'000) / 1000.0, expected, 0.05 * expected) << share;
    EXPECT_EQ(board.servo.shutdown, KZ_SHUTDOWN_OVERLOAD) << share;
    EXPECT_EQ(board.servo.shutdown_detail, kKnee);
    EXPECT_EQ(board.clear(), KZ_REFUSED_FAULT);  // still hot
  }
}

TEST_F(Protection, WhatIsHotCoolsDownAndThenCanBeCleared) {
  push(0.65);
  ASSERT_LT(until_off(300'000), 300'000);
  const double tau = 0.016 * 8192;
  board.ticks(static_cast<int>(1000 * tau * std::log(2.0) * 0.95));
  EXPECT_EQ(board.clear(), KZ_REFUSED_FAULT);
  board.ticks(static_cast<int>(1000 * tau * std::log(2.0) * 0.10));
  EXPECT_EQ(board.clear(), 0);
}

TEST_F(Protection, ASteadyLoadOfAThirdIsHeldForEver) {
  push(0.34);  // 0.78 Nm
  EXPECT_EQ(until_off(600'000), 600'000) << int(board.servo.shutdown);
}

// Rounded constants and cut bits: a whole is 252.
TEST_F(Protection, LoadIsDutyLessBackEmf) {
  kz_servo& servo = board.servo;
  servo.enabled = 1;
  servo.supply_mv = 10'000;
  joint().duty = 255;
  joint().forward = 1;
  const auto load_at = [&](double rad_per_s) {
    joint().rate = static_cast<s16>(std::lround(rad_per_s * 640));
    servo.phase = kKnee;
    kz_protection_update(&servo);
    return static_cast<int>(joint().load);
  };
  EXPECT_NEAR(load_at(0), 252, 1);
  EXPECT_NEAR(load_at(12.97), 0, 2);
  EXPECT_NEAR(load_at(6.485), 126, 1);
  EXPECT_EQ(load_at(-6), 255);  // driven against its motion: more than stalled
  servo.supply_mv = 5'000;
  EXPECT_NEAR(load_at(0), 126, 1);
}

TEST_F(Protection, LoadHasTheDirectionOfTheDrive) {
  kz_servo& servo = board.servo;
  servo.enabled = 1;
  servo.supply_mv = 10'000;
  servo.phase = kKnee;
  joint().duty = 255;
  // A motor that turns the way it is driven has no load at full speed, else twice the highest.
  for (const bool mirrored : {false, true}) {
    for (const bool forward : {false, true}) {
      joint().mirrored = mirrored;
      joint().forward = forward;
      const int direction = forward == mirrored ? -1 : 1;
      joint().rate = static_cast<s16>(direction * 8301);
      kz_protection_update(&servo);
      EXPECT_NEAR(joint().load, 0, 2) << mirrored << forward;
      joint().rate = static_cast<s16>(-direction * 8301);
      kz_protection_update(&servo);
      EXPECT_EQ(joint().load, 255) << mirrored << forward;
    }
  }
}

TEST_F(Protection, EveryJointHasItsTurn) {
  kz_servo& servo = board.servo;
  servo.enabled = 1;
  servo.supply_mv = 10'000;
  for (int driven = 0; driven < KZ_JOINTS; ++driven) {
    for (int j = 0; j < KZ_JOINTS; ++j) {
      servo.joint[j].duty = j == driven ? 255 : 0;
      servo.joint[j].forward = servo.joint[j].mirrored ^ 1;
    }
    for (u8 phase = 0; phase < KZ_PROTECTION_MS; ++phase) {
      servo.phase = phase;
      kz_protection_update(&servo);
    }
    for (int j = 0; j < KZ_JOINTS; ++j)
      EXPECT_NEAR(servo.joint[j].load, j == driven ? 252 : 0, 1) << j;
  }
}

TEST_F(Protection, HeatIsNoFaultWhileMotorsAreOff) {
  kz_servo& servo = board.servo;
  servo.phase = kKnee;
  servo.enabled = 0;
  joint().heat = u32{KZ_HEAT_FULL + 10} << 16;
  EXPECT_EQ(kz_protection_update(&servo), 0);
  servo.enabled = 1;
  EXPECT_EQ(kz_protection_update(&servo), KZ_SHUTDOWN_OVERLOAD << 8 | kKnee);
}

// A joint is constrained if it can reach a limit within 4 ms: it is nearer than its rate and 3,100.
class NearLimits : public Protection {
 protected:
  u8 constrained(int angle, int rate) {
    joint().angle = static_cast<s16>(angle);
    joint().rate = static_cast<s16>(rate);
    board.servo.phase = kKnee;
    kz_protection_update(&board.servo);
    return joint().constrained;
  }
};

TEST_F(NearLimits, AreDistancesThatGrowWithTheSpeedInEitherDirection) {
  joint().upper = 12'000;
  joint().lower = -11'000;
  for (const int rate : {0, 2000, -2000, 5200, -5200}) {
    const int far = KZ_FAR_FROM_LIMIT + std::abs(rate);
    EXPECT_EQ(constrained(0, rate), 0) << rate;
    EXPECT_EQ(constrained(12'000 - far, rate), KZ_CONSTRAINED_NEAR_LIMIT) << rate;
    EXPECT_EQ(constrained(12'000 - far - 1, rate), 0) << rate;
    EXPECT_EQ(constrained(-11'000 + far, rate), KZ_CONSTRAINED_NEAR_LIMIT) << rate;
    EXPECT_EQ(constrained(-11'000 + far + 1, rate), 0) << rate;
  }
}

TEST_F(NearLimits, DoNotMatterToAJointFasterThan8RadPerS) {
  joint().upper = 24'434;
  joint().lower = -24'434;
  for (const int rate : {5201, -5201, 20'000, -20'000, 32'704, -32'704})
    EXPECT_EQ(constrained(0, rate), KZ_CONSTRAINED_NEAR_LIMIT) << rate;
}

TEST_F(NearLimits, DeadBandAndFrictionStayAReason) {
  joint().upper = 12'000;
  joint().lower = -11'000;
  joint().constrained = KZ_CONSTRAINED_BY_FRICTION | KZ_CONSTRAINED_NEAR_LIMIT;
  EXPECT_EQ(constrained(0, 0), KZ_CONSTRAINED_BY_FRICTION);
  EXPECT_EQ(constrained(12'000, 0), KZ_CONSTRAINED_BY_FRICTION | KZ_CONSTRAINED_NEAR_LIMIT);
}

}  // namespace
}  // namespace kaz::test
