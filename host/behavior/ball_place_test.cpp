// A ball on the floor is found there from any posture whose soles are flat, and stays while walking.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/ball_place.h"

#include <gtest/gtest.h>

#include "host/motion/gait.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2d, Eigen::Vector3d;
constexpr double kRadius = 0.020;

// What the left eye sees of a ball on the floor, in the frame below the hips.
vision::BallObservation see(const host::JointAngles& angles, const Vector2d& from_hips, Time t,
                            double height = kRadius) {
  const host::Side foot = host::supporting_foot(angles);
  const Vector3d hips = motion::hips_over_sole(angles, foot);
  const Vector3d from_sole(hips.x() + from_hips.x(), hips.y() + from_hips.y(), height);
  const Vector3d in_eye = host::foot_from_eye(angles).inverse() * from_sole;
  vision::BallObservation seen;
  seen.found = true;
  seen.direction = in_eye.normalized();
  seen.distance_m = in_eye.norm();
  seen.info.exposure = t;
  seen.info.posture_known = true;
  seen.info.joint_rad.assign(angles.begin(), angles.end());
  return seen;
}

TEST(OnFloor, IsExactInAnyPhaseOfWalkingAndBent) {
  motion::Steps steps{.amplitude = 1, .left = 0.04, .right = 0.04};
  for (double phase = 0; phase < 1; phase += 0.05) {
    host::JointAngles angles = motion::legs_at({}, 20 * kDegree, phase, steps);
    angles[host::neck_tilt] = 0.6;
    angles[host::neck_pan] = 0.2;
    const auto point = on_floor(see(angles, {0.3, 0.1}, 0ms), kRadius);
    ASSERT_TRUE(point) << phase;
    EXPECT_NEAR((point->from_hips - Vector2d(0.3, 0.1)).norm(), 0, 1e-6) << phase;
  }
  host::JointAngles bent = motion::home();
  motion::place_legs(bent, {.x = -0.02, .z = 0.11, .pitch = 50 * kDegree}, {});
  const auto point = on_floor(see(bent, {0.12, -0.05}, 0ms), kRadius);
  ASSERT_TRUE(point);
  EXPECT_NEAR((point->from_middle - Vector2d(0.10, -0.05)).norm(), 0, 1e-6);
}

TEST(OnFloor, RefusesABallThatIsLiftedOrTooFar) {
  const host::JointAngles angles = motion::home();
  EXPECT_TRUE(on_floor(see(angles, {0.8, 0}, 0ms), kRadius));
  EXPECT_FALSE(on_floor(see(angles, {3.0, 0}, 0ms), kRadius)) << "the ray is too flat";
  EXPECT_FALSE(on_floor(see(angles, {0.12, -0.05}, 0ms, 0.17), kRadius)) << "in the hand";
  auto unknown = see(angles, {0.3, 0}, 0ms);
  unknown.info.posture_known = false;
  EXPECT_FALSE(on_floor(unknown, kRadius));
}

TEST(OnFloor, TheHeadIsPointedThere) {
  host::JointAngles angles = motion::home();
  const host::Gaze gaze = gaze_at_floor(angles, {0.3, -0.1, kRadius});
  angles[host::neck_pan] = gaze.pan_rad;
  angles[host::neck_tilt] = gaze.tilt_rad;
  EXPECT_NEAR(see(angles, {0.3, -0.1}, 0ms).direction.z(), 1, 1e-5);
}

// The robot walks 0.2 m and turns by 30 degrees; results come 40 ms late.
TEST(BallPlace, StandsStillWhileTheRobotWalksAndTurns) {
  BallPlace place(kRadius);
  PlaceHistory places;
  const host::JointAngles angles = motion::home();
  const Vector2d ball(0.6, 0.1);
  motion::Place robot;
  std::vector<vision::BallObservation> late;
  for (Time t = 0ms; t <= 4s; t += 10ms) {
    const double u = seconds(t) / 4;
    robot.x = 0.2 * u;
    robot.heading = 30 * kDegree * u;
    places.add(t, robot);
    const Vector2d from_hips = Eigen::Rotation2Dd(-robot.heading) * (ball - Vector2d(robot.x, 0));
    if (t % 40ms == 0ms) late.push_back(see(angles, from_hips, t));
    if (!late.empty() && t - late.front().info.exposure >= 40ms) {
      EXPECT_TRUE(place.observe(late.front(), places));
      late.erase(late.begin());
    }
  }
  ASSERT_TRUE(place.known());
  const Vector2d expected = Eigen::Rotation2Dd(-robot.heading) * (ball - Vector2d(0.2, 0));
  EXPECT_NEAR((place.from_hips(4s, robot) - expected).norm(), 0, 1e-3);
  EXPECT_LT(place.speed(), 5e-3);
  EXPECT_NEAR((place.at(4s) - ball).norm(), 0, 1e-3);
  place.forget();
  places.clear();
  EXPECT_FALSE(place.known());
  EXPECT_FALSE(place.observe(see(angles, expected, 4s), places)) << "no place is known";
}

TEST(BallPlace, KnowsHowFastABallRolls) {
  BallPlace place(kRadius);
  PlaceHistory places;
  const host::JointAngles angles = motion::home();
  for (Time t = 0ms; t <= 2s; t += 33ms) {
    places.add(t, {});
    EXPECT_TRUE(place.observe(see(angles, {0.5, -0.1 + 0.08 * seconds(t)}, t), places));
  }
  // The track expects it to slow down by 0.1 m/s^2, which this one does not.
  EXPECT_NEAR(place.speed(), 0.08, 0.016);
}

}  // namespace
}  // namespace kaz::behavior
