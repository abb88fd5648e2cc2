// The judge on truths made up here, at the bounds of each criterion, whatever is claimed.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/judge.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "host/behavior/behavior.h"
#include "shared/base/angle.hpp"

namespace kaz::tools {
namespace {

using behavior::Criterion;

const behavior::Outcome kClaims{true, "done", {}, {}};
const behavior::Outcome kAdmits{false, "not done", {}, "not reached"};

Eigen::Isometry3d at(double x, double y, double z, double yaw = 0, double pitch = 0) {
  return Eigen::Translation3d(x, y, z) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY());
}

// Standing at the origin, a ball 0.1 m ahead of the ankles and 47 mm aside; the eye looks along x, 30 cm up.
Truth standing(double time_s) {
  Truth truth{.time = from_seconds(time_s), .trunk = at(0, 0, 0.16)};
  truth.ball = Eigen::Vector3d(0.1, 0.047, 0.02);
  Eigen::Matrix3d optical;
  optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  truth.left_eye = Eigen::Translation3d(0, 0, 0.3) * Eigen::Isometry3d(optical);
  truth.left_foot = at(0, 0.033, 0.03);
  truth.right_foot = at(0, -0.033, 0.03);
  return truth;
}

// Looks ten times a second for `duration_s`; `change` makes each truth.
EpisodeVerdict judged(const Task& task, double duration_s,
                      const std::function<void(double, Truth&)>& change,
                      const behavior::Outcome& claim = kClaims, const JudgeOptions& options = {}) {
  Judge judge(options);
  for (int i = 0; i <= static_cast<int>(std::lround(10 * duration_s)); ++i) {
    Truth truth = standing(0.1 * i);
    change(0.1 * i, truth);
    judge.look(truth);
  }
  judge.end();
  // What comes after the end does not count.
  Truth lies = standing(duration_s + 1);
  lies.trunk = at(0, 0, 0.05, 0, 90 * kDegree);
  lies.ball = Eigen::Vector3d(5, 5, 0.02);
  judge.look(lies);
  return verdict_of(task, claim, judge);
}

TEST(Judge, CountsAWalkFromTheFirstRiseOfAnAnkle) {
  Judge judge({});
  for (int i = 0; i <= 100; ++i) {
    Truth truth = standing(0.1 * i);
    if (i == 20) truth.left_foot->translation().z() += 0.004;
    if (i == 30) truth.right_foot->translation().z() += 0.006;
    judge.look(truth);
    EXPECT_EQ(judge.walked_s().has_value(), i >= 30) << i;
  }
  ASSERT_TRUE(judge.walked_s());
  EXPECT_NEAR(*judge.walked_s(), 7, 1e-9);
  EXPECT_NEAR(judge.watched_s(), 10, 1e-9);
}

TEST(Judge, OfACatchIsTheBallInTheLastThreeSeconds) {
  const Task task{.criterion = Criterion::ball_held};
  const auto lifted = [](double from_s, double to_s) {
    return [=](double t, Truth& truth) {
      if (t > from_s && t < to_s) truth.ball->z() = 0.06;
    };
  };
  EXPECT_TRUE(judged(task, 5, lifted(1.85, 9)).success);
  EXPECT_EQ(judged(task, 5, lifted(2.15, 9)).cause, "not held");
  // Held for longer, and dropped before the end.
  EXPECT_EQ(judged(task, 10, lifted(1, 9.85)).cause, "not held");
  // Held, although the behavior does not believe it.
  const EpisodeVerdict unbelieved = judged(task, 5, lifted(1, 9), kAdmits);
  EXPECT_TRUE(unbelieved.success);
  EXPECT_FALSE(unbelieved.claim);
}

TEST(Judge, OfATrackIsTheEyesAxisForNineTenthsOfTheTime) {
  const Task task{.criterion = Criterion::ball_tracked, .seconds = 10};
  const auto on_ball = [](double until_s) {
    return [=](double t, Truth& truth) {
      const double off = (t < until_s ? 2.9 : 3.1) * kDegree;
      truth.ball = *truth.left_eye * (Eigen::Vector3d(std::sin(off), 0, std::cos(off)) * 0.5);
    };
  };
  EXPECT_TRUE(judged(task, 20, on_ball(19.15)).success);
  EXPECT_EQ(judged(task, 20, on_ball(18.85)).cause, "off the ball");
}

TEST(Judge, OfASearchIsTheReportedDirection) {
  const Task task{.criterion = Criterion::ball_direction};
  const Truth truth = standing(0);
  const Eigen::Vector3d ray = *truth.ball - truth.left_eye->translation();
  const double bearing = std::atan2(ray.y(), ray.x()) / kDegree;
  const double elevation = std::asin(ray.normalized().z()) / kDegree;
  const auto said = [&](double off_deg) {
    return judged(task, 1, [](double, Truth&) {},
                  {true,
                   "found",
                   {{"ball_bearing_deg", bearing}, {"ball_elevation_deg", elevation + off_deg}},
                   {}});
  };
  EXPECT_TRUE(said(4.9).success);
  EXPECT_EQ(said(-5.1).cause, "wrong direction");
  EXPECT_EQ(judged(task, 1, [](double, Truth&) {}).cause, "no direction");
}

TEST(Judge, OfAnApproachIsTheBallBeforeAHand) {
  const Task task{.criterion = Criterion::ball_in_reach};
  const auto ball_at = [&](double x, double y) {
    return judged(task, 1, [=](double, Truth& truth) {
      // Wherever the robot stands and looks to.
      const Eigen::Isometry3d there = at(1, -2, 0, 2);
      truth.trunk = there * truth.trunk;
      truth.left_foot = there * *truth.left_foot;
      truth.right_foot = there * *truth.right_foot;
      truth.ball = there * Eigen::Vector3d(x, y, 0.02);
    });
  };
  EXPECT_TRUE(ball_at(0.125, 0.073).success);
  EXPECT_TRUE(ball_at(0.075, -0.021).success);
  EXPECT_EQ(ball_at(0.127, 0.047).cause, "out of reach");
  EXPECT_EQ(ball_at(0.100, 0.010).cause, "out of reach");
}

TEST(Judge, OfStandingAndGettingUpIsTheTrunkUprightAndHigh) {
  const auto pose = [](double pitch_deg, double height_m, double from_s) {
    return judged({.criterion = Criterion::upright}, 6,
                  [=](double t, Truth& truth) {
                    truth.trunk = t < from_s ? at(0, 0, 0.05, 0, 80 * kDegree)
                                             : at(0, 0, height_m, 0, pitch_deg * kDegree);
                  },
                  kClaims, {.lies = true});
  };
  EXPECT_TRUE(pose(25, 0.14, 2.95).success);
  EXPECT_FALSE(pose(25, 0.14, 3.15).success);
  EXPECT_FALSE(pose(35, 0.14, 1).success);
  EXPECT_FALSE(pose(0, 0.07, 1).success) << "it sits";
  EXPECT_EQ(pose(0, 0.07, 9).cause, "lies");
}

TEST(Judge, OfAFallIsTheTrunk) {
  const auto leaning = [](double deg) {
    return judged({.criterion = Criterion::ball_held}, 5, [=](double t, Truth& truth) {
      truth.ball->z() = 0.1;
      if (t < 0.5) truth.trunk = at(0, 0, 0.1, 0, deg * kDegree);
    });
  };
  EXPECT_TRUE(leaning(59).success);
  EXPECT_EQ(leaning(61).cause, "fell");
}

TEST(Judge, OfAWalkAndATurnIsTheTrunksWay) {
  const auto moved = [](const Task& task, double x, double y, double yaw_deg) {
    return judged(task, 1, [=](double t, Truth& truth) {
      truth.trunk = at(t * x, t * y, 0.14, t * yaw_deg * kDegree);
    });
  };
  EXPECT_TRUE(moved({.criterion = Criterion::walked, .distance_m = 1}, 0.91, 0, 7).success);
  EXPECT_EQ(moved({.criterion = Criterion::walked, .distance_m = 1}, 0.89, 0, 0).cause, "distance");
  EXPECT_EQ(moved({.criterion = Criterion::walked, .distance_m = -1}, 1, 0, 0).cause, "distance");
  EXPECT_EQ(moved({.criterion = Criterion::walked, .distance_m = 1}, 1, 0, 9).cause, "heading");
  EXPECT_TRUE(
      moved({.criterion = Criterion::turned_right, .angle_rad = -90 * kDegree}, 0, 0, -95).success);
  EXPECT_EQ(
      moved({.criterion = Criterion::turned_right, .angle_rad = -90 * kDegree}, 0, 0, -97).cause,
      "heading");
  EXPECT_TRUE(moved({.criterion = Criterion::at_goal, .goal = {1, 0.5}}, 1.03, 0.47, 0).success);
  EXPECT_EQ(moved({.criterion = Criterion::at_goal, .goal = {1, 0.5}}, 1.05, 0.55, 0).cause,
            "beside the goal");
}

TEST(Judge, BelievesNoErrorAndNoUnknownTask) {
  Judge judge({});
  judge.look(standing(0));
  judge.look(standing(5));
  EXPECT_EQ(
      verdict_of({.criterion = Criterion::upright}, fail(Fault::failed, "broken"), judge).cause,
      "error");
  EXPECT_TRUE(verdict_of({.criterion = Criterion::upright}, kClaims, judge).judged);
  const EpisodeVerdict unknown = verdict_of({}, kClaims, judge);
  EXPECT_TRUE(unknown.success && !unknown.judged);
  EXPECT_EQ(verdict_of({}, kAdmits, judge).cause, "not reached");
}

// A behavior of Kaz without a judge would be believed.
TEST(Judge, KnowsEachOfKazsBehaviors) {
  for (const auto& one : behavior::behaviors()) {
    // These two do what somebody wants of them: there is no measure of that.
    const bool measured = one.name != "play" && one.name != "pose";
    EXPECT_EQ(one.evaluation.criterion != Criterion::claim, measured) << one.name;
    const auto defaults = behavior::OptionValues::parse(one.options, {});
    ASSERT_TRUE(defaults);
    if (one.name != "navigate") {
      EXPECT_TRUE(task_of(one, *defaults)) << one.name;
    }
  }
  const auto none = task_of(behavior::kGoForward, behavior::OptionValues());
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("distance"), std::string::npos) << none.error().message;
}

}  // namespace
}  // namespace kaz::tools
