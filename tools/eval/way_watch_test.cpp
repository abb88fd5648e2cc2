// What counts as noticed of a thing that slides into the way.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/way_watch.h"

#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

namespace kaz::tools {
namespace {

using Eigen::Vector2d;

// Pushed at 1 s from 0.6 m to the left onto the line ahead, where it arrives at 2 s. The robot walks at
// 5 cm/s.
class WayWatchTest : public testing::Test {
 protected:
  WayWatchTest() {
    thing_.x_m = 0.8;
    thing_.y_m = 0.6;
    thing_.slide = Slide{1, {0, -0.6}};
    watch_.emplace(thing_, "thing0");
  }
  void until(double end_s) {
    for (; time_ < end_s; time_ += 0.02) {
      const double share = std::clamp(time_ - 1, 0.0, 1.0);
      watch_->look(from_seconds(time_), thing_.place() + share * thing_.slide->by_m,
                   {0.05 * time_, 0});
    }
  }
  void plan(const std::vector<Vector2d>& path) { watch_->plan(from_seconds(time_), path); }

  Obstacle thing_;
  std::optional<WayWatch> watch_;
  double time_ = 0;
  const std::vector<Vector2d> straight_{{0, 0}, {1.4, 0}}, around_{{0.2, 0}, {0.8, -0.3}, {1.4, 0}};
};

TEST_F(WayWatchTest, AThingOnThePathIsInTheWayAndAPlanAroundItNotices) {
  plan(straight_);
  until(1.9);
  EXPECT_FALSE(watch_->arrived());
  until(3);
  EXPECT_TRUE(watch_->arrived());
  EXPECT_TRUE(watch_->in_the_way());
  plan({{0.15, 0}, {1.4, 0}});  // again through it
  EXPECT_FALSE(watch_->noticed_s());
  until(4);
  plan(around_);
  ASSERT_TRUE(watch_->noticed_s());
  EXPECT_NEAR(*watch_->noticed_s(), 2, 0.1);
  EXPECT_NEAR(watch_->json()["nearest_m"].get<double>(), 0.8 - 0.05 - 0.2, 0.01);
}

TEST_F(WayWatchTest, NoPathNoticesToo) {
  plan(straight_);
  until(3);
  plan({});
  EXPECT_TRUE(watch_->noticed_s());
}

TEST_F(WayWatchTest, ThePlanThatThereWasIsReportedAgainAtTheEnd) {
  plan(straight_);
  until(3);
  plan(straight_);
  EXPECT_FALSE(watch_->noticed_s());
}

TEST_F(WayWatchTest, BesideThePathOrBehindTheRobotItIsNotInTheWay) {
  plan(around_);
  until(3);
  EXPECT_TRUE(watch_->arrived());
  EXPECT_FALSE(watch_->in_the_way());
  watch_.emplace(thing_, "thing0");
  time_ = 0;
  plan({{-1, 0}, {0.8, 0}, {0.8, -0.9}, {2, -0.9}});
  for (; time_ < 3; time_ += 0.02)
    watch_->look(from_seconds(time_), {0.8, 0.6 - 0.6 * std::clamp(time_ - 1, 0.0, 1.0)},
                 {0.8, -0.5});
  EXPECT_TRUE(watch_->arrived());
  EXPECT_FALSE(watch_->in_the_way());
}

TEST_F(WayWatchTest, BeforeThereIsAPlanNothingIsInItsWay) {
  until(3);
  plan(straight_);
  plan(around_);
  EXPECT_FALSE(watch_->in_the_way());
  EXPECT_FALSE(watch_->noticed_s());
}

}  // namespace
}  // namespace kaz::tools
