// catch-ball from a place to the side, and its reactions when something goes wrong.
// SPDX-License-Identifier: Apache-2.0
//
// One run with the emulated firmware and real eyes; the others with the firmware built for the host and
// ideal eyes, because they are of what is decided, and four times as fast.
#include <gtest/gtest.h>

#include "tests/system/catching/scene_testing.h"

namespace kaz::catching {
namespace {

constexpr double kLifted = 0.10;  // m; standing, the hand is 0.15 m above the floor

std::string description(const Ending& ending) {
  std::string text = ending.outcome.sentence + " [" + ending.outcome.cause + "]";
  for (const std::string& phase : ending.phases) text += " " + phase;
  return text;
}

TEST(CatchBall, LiftsAndHoldsASmallBallFromTheSide) {
  Scene scene;
  scene.mcu = sim::McuKind::h8;
  scene.eyes = sim::EyeKind::real;
  scene.ball = {0.22, 0.24};
  scene.radius = 0.018;
  const auto ending = play(scene);
  ASSERT_TRUE(ending) << ending.error().message;
  EXPECT_TRUE(ending->outcome.success) << description(*ending);
  EXPECT_FALSE(ending->fell);
  EXPECT_GT(ending->ball.z(), kLifted) << description(*ending);
}

// Flicked off while the robot walks toward it: it searches all around once more, and reports that.
TEST(CatchBall, SearchesAgainWhenTheBallIsTakenAway) {
  Scene scene;
  scene.ball = {0.45, 0};
  scene.kicks = {{13, {5, 2, 3}}};
  const auto ending = play(scene);
  ASSERT_TRUE(ending) << ending.error().message;
  EXPECT_FALSE(ending->outcome.success);
  EXPECT_EQ(ending->outcome.cause, "not found") << description(*ending);
  EXPECT_TRUE(ending->did("walk"));
  // The first search and four scans of the second.
  EXPECT_GE(ending->times("search"), 5) << description(*ending);
  EXPECT_GE(ending->times("turn"), 3) << description(*ending);
  EXPECT_FALSE(ending->fell);
}

TEST(CatchBall, DoesNotMindABallOfAnotherColour) {
  Scene scene;
  scene.ball = {0.28, -0.10};
  scene.other_balls = {{0.24, 0.09}, {0.45, -0.02}};
  const auto ending = play(scene);
  ASSERT_TRUE(ending) << ending.error().message;
  EXPECT_TRUE(ending->outcome.success) << description(*ending);
  EXPECT_GT(ending->ball.z(), kLifted);
}

// It rolls by 10 cm or so, at first at 0.12 m/s: the robot follows and takes it when it rests.
TEST(CatchBall, FollowsABallThatRollsAndTakesItWhenItRests) {
  Scene scene;
  scene.ball = {0.36, -0.12};
  scene.rolling_resistance = 0.0002;
  scene.kicks = {{12, {0, 0.12, 0}}};
  const auto ending = play(scene);
  ASSERT_TRUE(ending) << ending.error().message;
  EXPECT_TRUE(ending->outcome.success) << description(*ending);
  EXPECT_GT(ending->ball.z(), kLifted);
}

TEST(CatchBall, StandsAndWaitsWhileTheCameraIsFrozen) {
  Scene scene;
  scene.ball = {0.5, 0.02};
  scene.frozen_from_s = 11;
  scene.frozen_for_s = 1;
  const auto ending = play(scene);
  ASSERT_TRUE(ending) << ending.error().message;
  EXPECT_TRUE(ending->outcome.success) << description(*ending);
  EXPECT_GE(ending->times("walk"), 2) << "stopped and went on: " << description(*ending);
  EXPECT_LT(ending->walked_while_frozen, 0.04) << "no more than to end the step";
}

// A knee with half its torque carries the robot all the same: it catches, or reports why not.
TEST(CatchBall, GoesOnWithAKneeOfHalfTheTorque) {
  Scene scene;
  scene.ball = {0.3, -0.1};
  scene.faults = {"at 1 s motor_weak joint l_knee 0.5"};
  const auto ending = play(scene);
  ASSERT_TRUE(ending) << ending.error().message;
  EXPECT_TRUE(ending->outcome.success) << description(*ending);
  EXPECT_FALSE(ending->fell);
}

// Whatever spoils the first grasp, it notices, opens, stands up and begins anew.
void expect_second_grasp(const Scene& scene) {
  const auto ending = play(scene);
  ASSERT_TRUE(ending) << ending.error().message;
  EXPECT_EQ(ending->times("close"), 2) << description(*ending);
  EXPECT_EQ(ending->times("stand up"), 1) << description(*ending);
  EXPECT_TRUE(ending->outcome.success) << description(*ending);
  EXPECT_GT(ending->ball.z(), kLifted) << description(*ending);
  EXPECT_FALSE(ending->fell);
}

// Between the last look, up to 16.05 s, and the hand's closing at 17.36 s. The ball lies before the
// hand from the start, so that nothing but the search decides these times.
TEST(CatchBall, TriesAgainWhenTheBallIsPushedAwayUnderTheHand) {
  Scene scene;
  scene.ball = {0.10, -0.047};
  scene.kicks = {{16.5, {0.25, 0, 0}}};
  expect_second_grasp(scene);
}

TEST(CatchBall, TriesAgainWhenTheBallSlipsOutOnTheWayUp) {
  Scene scene;
  scene.ball = {0.10, -0.047};
  scene.fault_phase = "lift";
  scene.fault_then = "for 1.5 s joint_slipping joint r_hand 0";
  expect_second_grasp(scene);
}

TEST(SearchBall, TurnsTheBodyWhenTheHeadSeesNothing) {
  Scene scene;
  scene.behavior = "search-ball";
  scene.options = {{"turns", "3"}, {"seconds", "200"}};
  scene.ball = {-0.45, 0.05};
  const auto found = play(scene);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->outcome.success) << description(*found);
  EXPECT_TRUE(found->did("turn"));
}

}  // namespace
}  // namespace kaz::catching
