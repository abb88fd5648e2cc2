// Motion with an ideal body that follows its targets exactly: commands, their order, their ends.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kaz::motion {
namespace {

// Joints follow at once. While both feet carry and move against each other it turns by `slip_yield` of what
// soles that did not slip would turn it by.
class Body {
 public:
  explicit Body(bool gyro, Settings settings = {}) : motion(settings), gyro_(gyro) {
    posture_.angle = home();
  }

  void cycle() {
    time_ += 0.012;
    posture_.time = from_seconds(time_);
    const JointAngles before = posture_.angle;
    if (gyro_) {
      posture_.inertial = host::Inertial{
          .time = posture_.time, .yaw_rate_rad_per_s = 0.3 + rate, .forward_m_per_s2 = forward};
    }
    for (const host::JointTarget& target : motion.step(from_seconds(time_), posture_))
      posture_.angle[static_cast<std::size_t>(target.joint)] = target.angle_rad;
    for (std::size_t j = 0; j < before.size(); ++j)
      fastest = std::max(fastest, std::abs(posture_.angle[j] - before[j]) / 0.012);
    // Both soles against each other, while both carry.
    const auto ahead = [&](const JointAngles& angles, Side side) {
      return -hips_over_sole(angles, side).x();
    };
    // Where the left foot goes ahead and stays, its side of the body goes back: to the left.
    const double slip = ahead(posture_.angle, Side::left) - ahead(before, Side::left) -
                        ahead(posture_.angle, Side::right) + ahead(before, Side::right);
    const bool both = left_share({.period = 2.2}, motion.phase(), motion.amplitude()) == 0.5;
    rate = motion.state() == State::turning && both ? slip_yield * slip / 0.066 / 0.012 : 0;
    turned += rate * 0.012;
  }
  void stand(double seconds) {
    for (double t = 0; t < seconds; t += 0.012) cycle();
  }
  double until_idle() {
    const double start = time_;
    while (!motion.idle() && motion.state() != State::fallen && time_ - start < 120) cycle();
    return time_ - start;
  }

  Motion motion;
  double rate = 0, turned = 0, fastest = 0, forward = 0, slip_yield = 0.35;

 private:
  bool gyro_;
  host::Posture posture_;
  double time_ = 1;
};

// Ten millimetres are a quarter of a stride: the ramp down's last steps are as long as they are planned.
TEST(Motion, WalksADistanceAndStopsThere) {
  for (const double distance : {0.06, 0.1, 0.25, 1.0, -0.3}) {
    Body body(true);
    body.stand(1);
    EXPECT_TRUE(body.motion.idle());
    body.motion.walk(distance);
    EXPECT_LT(body.until_idle(), 60);
    EXPECT_NEAR(body.motion.walked(), distance, 0.010);
    EXPECT_LT(body.fastest, 12) << "rad/s, what the motors do";
  }
}

// On floors that let it turn by a half and by twice of what is first guessed.
TEST(Motion, TurnsByTheGyroWhateverTheFloor) {
  for (const double yield : {0.15, 0.35, 0.6}) {
    for (const double angle : {45.0, -45.0, 120.0, 5.0}) {
      Body body(true);
      body.slip_yield = yield;
      body.stand(3);
      body.motion.turn(angle * kDegree);
      EXPECT_LT(body.until_idle(), 60);
      EXPECT_NEAR(body.turned / kDegree, angle, 4) << yield;
      EXPECT_NEAR(body.motion.heading() / kDegree, body.turned / kDegree, 1.5);
    }
  }
}

TEST(Motion, ReckonsWithoutAGyro) {
  Body body(false);
  body.stand(1);
  EXPECT_FALSE(body.motion.has_gyro());
  body.motion.turn(-45 * kDegree);
  EXPECT_LT(body.until_idle(), 60);
  EXPECT_NEAR(body.motion.heading() / kDegree, -45, 3);
  EXPECT_LT(body.turned, -0.2) << "it turned to the right";
  EXPECT_GT(body.motion.place().sigma_heading, 5 * kDegree) << "and reports the large uncertainty";
}

TEST(Motion, StopsWithinTwoCycles) {
  Body body(true);
  body.motion.walk(3);
  body.stand(5);
  EXPECT_EQ(body.motion.state(), State::walking);
  body.motion.stop();
  EXPECT_LT(body.until_idle(), 2);
  EXPECT_EQ(body.motion.amplitude(), 0);
  const double walked = body.motion.walked();
  body.stand(2);
  EXPECT_NEAR(body.motion.walked(), walked, 1e-4) << "within the movement of the last cycle";
}

TEST(Motion, GoesFromWalkingToTurningThroughStanding) {
  Body body(true);
  body.stand(3);
  body.motion.walk(1);
  body.stand(4);
  body.motion.turn(30 * kDegree);
  bool stood = false;
  while (body.motion.state() != State::turning) {
    body.cycle();
    stood = stood || body.motion.amplitude() == 0;
  }
  EXPECT_TRUE(stood);
  body.until_idle();
  EXPECT_NEAR(body.turned / kDegree, 30, 4);
}

TEST(Motion, KnowsThatItLies) {
  Body body(true);
  body.stand(1);
  body.motion.walk(1);
  body.stand(1);
  body.forward = 9.81;  // on its back
  body.stand(0.2);
  EXPECT_NE(body.motion.state(), State::fallen) << "a jolt is no fall";
  body.stand(1);
  EXPECT_EQ(body.motion.state(), State::fallen);
  EXPECT_FALSE(body.motion.idle());
  body.forward = 0;
  body.motion.walk(1);
  body.stand(1);
  EXPECT_EQ(body.motion.state(), State::fallen) << "for good";
}

}  // namespace
}  // namespace kaz::motion
