// The robot stands by its firmware: it does not drift, and takes pushes.
// SPDX-License-Identifier: Apache-2.0
//
// KAZ_LONG=1: the minute of standing for both postures.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/system/virtual_robot/robot_testing.h"

namespace kaz {
namespace {

struct Moved {
  double mm = 0, degrees = 0;
  void widen(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
    const Eigen::Isometry3d motion = from.inverse() * to;
    mm = std::max(mm, 1e3 * motion.translation().norm());
    degrees = std::max(degrees, std::abs(Eigen::AngleAxisd(motion.linear()).angle()) / kDegree);
  }
};

struct Stood {
  Moved trunk, soles;  // largest, from where they were
  Moved drift;         // of the trunk: its mean place in the last sixth against that in the first
};

// Mean of poses that differ little from the first of them.
class MeanPose {
 public:
  void add(const Eigen::Isometry3d& pose) {
    if (count_ == 0) first_ = pose;
    const Eigen::Isometry3d motion = first_.inverse() * pose;
    const Eigen::AngleAxisd turn(motion.linear());
    way_ += motion.translation();
    turn_ += turn.angle() * turn.axis();
    ++count_;
  }
  Eigen::Isometry3d mean() const {
    const Eigen::Vector3d turn = turn_ / count_;
    return first_ * Eigen::Translation3d(way_ / count_) *
           Eigen::AngleAxisd(turn.norm(), turn.normalized());
  }

 private:
  int count_ = 0;
  Eigen::Isometry3d first_ = Eigen::Isometry3d::Identity();
  Eigen::Vector3d way_ = Eigen::Vector3d::Zero(), turn_ = Eigen::Vector3d::Zero();
};

Stood stand(RobotFixture& fixture, const char* posture) {
  const double for_s = long_run() ? 60 : 6, begin = fixture.time_s();
  const auto left_sole = [&] { return fixture.world().link_pose("l_ankle_pitch"); };
  const auto right_sole = [&] { return fixture.world().link_pose("r_ankle_pitch"); };
  const Eigen::Isometry3d start = fixture.trunk(), left = left_sole(), right = right_sole();
  Stood stood;
  MeanPose early, late;
  while (fixture.time_s() < begin + for_s) {
    fixture.wait(0.05);
    stood.trunk.widen(start, fixture.trunk());
    stood.soles.widen(left, left_sole());
    stood.soles.widen(right, right_sole());
    if (fixture.time_s() < begin + for_s / 6) early.add(fixture.trunk());
    if (fixture.time_s() > begin + for_s * 5 / 6) late.add(fixture.trunk());
  }
  stood.drift.widen(early.mean(), late.mean());
  std::printf(
      "%s: trunk at most %.3f mm, %.3f degrees, drifts %.3f mm, %.3f degrees; "
      "soles at most %.3f mm, %.3f degrees\n",
      posture, stood.trunk.mm, stood.trunk.degrees, stood.drift.mm, stood.drift.degrees,
      stood.soles.mm, stood.soles.degrees);
  return stood;
}

TEST(StandingRobot, DoesNotDriftInItsCrouch) {
  const auto fixture = RobotFixture::start(world_of(""));
  ASSERT_TRUE(fixture);
  fixture->stand_in_crouch();
  const Stood stood = stand(*fixture, "crouch");
  for (const Moved& moved : {stood.trunk, stood.drift, stood.soles}) {
    EXPECT_LT(moved.mm, 1.0);
    EXPECT_LT(moved.degrees, 0.5);
  }
}

// On straight legs nothing loads the joints, and the trunk sways by the backlash: 0.4 degrees in the
// ankles and as much in the hips (docs/limits.md). What it must not do is wander.
TEST(StandingRobot, DoesNotDriftUpright) {
  const auto fixture = RobotFixture::start(world_of(""), 2);
  ASSERT_TRUE(fixture);
  fixture->wait(1.0);
  const Stood stood = stand(*fixture, "upright");
  for (const Moved& moved : {stood.drift, stood.soles}) {
    EXPECT_LT(moved.mm, 1.0);
    EXPECT_LT(moved.degrees, 0.5);
  }
  EXPECT_LT(stood.trunk.mm, 1.3);
  EXPECT_LT(stood.trunk.degrees, 0.8);
}

// A ball flies at the trunk from a direction; returns the impulse it gave, Ns, and leaves the robot
// 3 s to recover.
struct Push {
  double given_ns = 0, tilt_deg = 0;
};

Push push(double from_rad, double mass_kg, double speed) {
  const double distance = 0.45;
  // The trunk's middle is 0.20 above the floor in the crouch; the ball falls g d^2 / (2 v^2) less
  // what its throw lifts it, from a shelf as high as it arrives.
  const double lift = 9.81 * distance / speed / 2;
  char at[80], kick[120], shelf[400];
  const double x = distance * std::cos(from_rad), y = distance * std::sin(from_rad);
  std::snprintf(at, sizeof at, "%.4f %.4f 0.205", x, y);
  std::snprintf(kick, sizeof kick, "<kaz:kick time=\"3.5\" velocity=\"%.4f %.4f %.4f\"/>",
                -speed * std::cos(from_rad), -speed * std::sin(from_rad), lift);
  std::snprintf(shelf, sizeof shelf,
                "<model name=\"shelf\"><static>true</static><pose>%.4f %.4f 0.09 0 0 %.4f</pose>"
                "<link name=\"l\"><collision name=\"c\"><geometry><box><size>0.06 0.06 0.18</size>"
                "</box></geometry></collision></link></model>",
                x, y, from_rad);
  Push result;
  const auto fixture = RobotFixture::start(world_of(shelf + ball(at, mass_kg, 0.025, kick)));
  if (!fixture) return result;
  fixture->stand_in_crouch();
  EXPECT_LT(fixture->time_s(), 3.4);
  EXPECT_LT((fixture->ball() - Eigen::Vector3d(x, y, 0.205)).norm(), 0.003) << "still on its shelf";
  // The ball's horizontal speed towards the robot before and after it has touched.
  const Eigen::Vector3d towards(-std::cos(from_rad), -std::sin(from_rad), 0);
  Eigen::Vector3d last = fixture->ball();
  double before = 0, after = 0, fastest = 0;
  while (fixture->time_s() < 4.5) {
    fixture->wait(0.005);
    const double v = (fixture->ball() - last).dot(towards) / 0.005;
    last = fixture->ball();
    fastest = std::max(fastest, v);
    if (fastest > 0.5 * speed && before == 0 && v < 0.9 * fastest) before = fastest;
    if (before > 0 && after == 0 && fixture->time_s() > 3.5 + distance / speed + 0.03) after = v;
  }
  result.given_ns = mass_kg * (before - after);
  fixture->wait(2.5);
  result.tilt_deg = fixture->tilt_deg();
  return result;
}

TEST(StandingRobot, SurvivesPushesByAFlyingBall) {
  for (int k = 0; k < 4; ++k) {
    const double from = k * std::numbers::pi / 2;
    const Push survived = push(from, 0.1, 3.3);
    std::printf("push from %3d degrees: %.3f Ns, then %.2f degrees off upright\n", 90 * k,
                survived.given_ns, survived.tilt_deg);
    EXPECT_GT(survived.given_ns, 0.30) << "from " << 90 * k;
    EXPECT_LT(survived.tilt_deg, 5.0) << "from " << 90 * k;
  }
}

}  // namespace
}  // namespace kaz
