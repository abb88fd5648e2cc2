// Planning: known answers, the exhaustive search as judge, and outlines by brute force.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/plan.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "host/plan/grid_planner.h"
#include "host/plan/plan_testing.h"

namespace kaz::plan {
namespace {

using Eigen::Vector2d;
using map::CellState;

constexpr double kPi = std::numbers::pi;

INSTANTIATE_TEST_SUITE_P(Grid, EachPlanner, testing::Values([] { return make_grid_planner(); }));

// A wall across, with the goal behind it: the nearest place is before the wall, as far as the robot is wide.
// Unknown floor is passed, but not stopped at.
TEST(NearestReachable, IsBeforeTheWallOnFloorThatWasSeen) {
  Grid grid = floor_grid();
  const PlanOptions options;
  const auto fill = [&](double x0, double x1, CellState state) {
    for (int x = 0; x < grid.cells_x; ++x)
      for (int y = 0; y < grid.cells_y; ++y)
        if (grid.middle(x, y).x() > x0 && grid.middle(x, y).x() < x1)
          grid.state[grid.index(x, y)] = state;
  };
  fill(1.0, 1.05, CellState::obstacle);
  const Vector2d from(0.3, 0), goal(1.4, 0);
  const auto near = nearest_reachable(grid, from, goal, options);
  ASSERT_TRUE(near);
  EXPECT_NEAR(near->x(), 1.0 - options.radius_m, 0.02);
  EXPECT_NEAR(near->y(), 0, 0.02);
  fill(0.5, 0.6, CellState::unknown);
  EXPECT_NEAR(nearest_reachable(grid, from, goal, options)->x(), 1.0 - options.radius_m, 0.02);
  fill(0.6, 1.0, CellState::unknown);
  EXPECT_NEAR(nearest_reachable(grid, from, goal, options)->x(), 0.5, 0.02);
  EXPECT_FALSE(nearest_reachable(grid, {1.02, 0}, goal, options)) << "it stands in the wall";
}

TEST_P(EachPlanner, StraightAheadIsOneLeg) {
  const PlanOptions options;
  const Path path = path_of(planned(floor_grid(), {{0.3, 0}, 0}, {{1.3, 0}, {}}));
  ASSERT_EQ(path.legs.size(), 1u);
  EXPECT_EQ(path.legs[0].kind, Leg::Kind::go);
  EXPECT_NEAR(path.legs[0].amount, 1, 1e-12);
  EXPECT_NEAR(path.seconds, options.go_s_per_m, 1e-9);
}

TEST_P(EachPlanner, TurnsGoesAndTurnsInFreeSpace) {
  const PlanOptions options;
  const double aside = std::atan2(0.37, 1.0);
  const Path path = path_of(planned(floor_grid(), {{0.3, 0.1}, -0.4}, {{1.3, 0.47}, 1.2}));
  ASSERT_EQ(path.legs.size(), 3u);
  EXPECT_NEAR(path.legs[0].amount, aside + 0.4, 1e-9);
  EXPECT_NEAR(path.legs[1].amount, std::hypot(0.37, 1.0), 1e-9);
  EXPECT_NEAR(path.legs[2].amount, 1.2 - aside, 1e-9);
  EXPECT_NEAR(path.seconds,
              options.turn_s_per_rad * 1.6 + options.go_s_per_m * std::hypot(0.37, 1.0), 1e-9);
}

TEST_P(EachPlanner, TurnsTheShorterWay) {
  const Path path = path_of(planned(floor_grid(), {{1, 0}, 3}, {{0.5, -0.02}, -3.0}));
  double turned = 0;
  for (const Leg& leg : path.legs)
    if (leg.kind == Leg::Kind::turn) turned += std::abs(leg.amount);
  EXPECT_LT(turned, 0.4);
}

TEST_P(EachPlanner, WhereTheRobotIsAlreadyNothingIsToBeDone) {
  const Path path = path_of(planned(floor_grid(), {{1, 0}, 0.5}, {{1, 0}, 0.5}));
  EXPECT_TRUE(path.legs.empty());
  EXPECT_EQ(path.seconds, 0);
}

TEST_P(EachPlanner, GoesThroughAGapThatIsWideEnough) {
  PlanOptions options;
  const auto with_gap = [](double width_m) {
    Grid grid = floor_grid();
    fill(grid, {0.9, -1}, {1.0, 0.3}, CellState::obstacle);
    fill(grid, {0.9, 0.3 + width_m}, {1.0, 1}, CellState::obstacle);
    return grid;
  };
  const Grid wide = with_gap(0.36);
  const Pose start{{0.3, -0.5}, 0};
  const Path path = path_of(planned(wide, start, {{1.7, -0.5}, {}}));
  const Walked end = walked(wide, start, path);
  EXPECT_LT((end.end.position - Vector2d(1.7, -0.5)).norm(), 1e-6);
  EXPECT_GE(end.clear_m, options.radius_m - wide.cell_m);

  const Planned none = planned(with_gap(0.16), start, {{1.7, -0.5}, {}});
  ASSERT_TRUE(std::holds_alternative<NoPath>(none));
  const NoPath& why = std::get<NoPath>(none);
  EXPECT_EQ(why.why, NoPath::Why::enclosed);
  EXPECT_NEAR(why.clear_m, 0.08, 0.012);
  EXPECT_NEAR(why.where.y(), 0.38, 0.1) << text(why, options);
  EXPECT_NEAR(why.where.x(), 0.95, 0.07) << text(why, options);
}

TEST_P(EachPlanner, SaysWhatIsInTheWayOfStartOrGoal) {
  Grid grid = floor_grid();
  fill(grid, {1.2, 0.2}, {1.3, 0.3}, CellState::obstacle);
  const auto why = [&](const Vector2d& from, const Vector2d& to) {
    const Planned none = planned(grid, {from, 0}, {to, {}});
    return std::holds_alternative<NoPath>(none) ? text(std::get<NoPath>(none), {}) : "a path";
  };
  EXPECT_EQ(
      why({0.3, 0}, {1.25, 0.12}),
      "the goal is 0.07 m from an obstacle at (1.255, 0.205); the robot needs a distance of at "
      "least 0.16 m");
  EXPECT_EQ(
      why({1.25, 0.12}, {0.3, 0}),
      "the robot is 0.07 m from an obstacle at (1.255, 0.205); the robot needs 0.16 m to turn");
  EXPECT_EQ(why({0.3, 0}, {2.5, 0}), "the goal is not on the map");
  EXPECT_EQ(why({0.3, 0}, {1e300, 0}), "the goal is not on the map");
  EXPECT_EQ(why({-0.3, 0}, {1.5, 0}), "the robot is not on the map");
}

TEST_P(EachPlanner, UnknownFloorCostsOrIsClosed) {
  Grid grid = floor_grid();
  fill(grid, {0.8, -0.2}, {1.2, 0.2}, CellState::unknown);
  const Pose start{{0.3, 0}, 0};
  const Goal goal{{1.7, 0}, {}};
  PlanOptions options;
  options.unknown_factor = 1;
  EXPECT_EQ(path_of(planned(grid, start, goal, options)).legs.size(), 1u);
  options.unknown_factor = std::numeric_limits<double>::infinity();
  const Path around = path_of(planned(grid, start, goal, options));
  EXPECT_GT(around.legs.size(), 2u);
  fill(grid, {0.8, -1}, {1.2, 1}, CellState::unknown);
  EXPECT_TRUE(std::holds_alternative<NoPath>(planned(grid, start, goal, options)));
}

TEST(Plan, TurnsOf45DegreesFromTheStartsHeading) {
  PlanOptions options;
  options.any_heading = false;
  const Pose start{{0.3, -0.6}, 0.3};
  Random random(5);
  const Grid grid = random_grid(random, start.position, {1.6, 0.5});
  const Path path = path_of(planned(*make_grid_planner(), grid, start, {{1.6, 0.5}, {}}, options));
  for (const Leg& leg : path.legs) {
    if (leg.kind != Leg::Kind::turn) continue;
    EXPECT_NEAR(std::remainder(leg.amount, kPi / 4), 0, 1e-9) << leg.amount;
  }
  const Walked end = walked(grid, start, path);
  EXPECT_LT((end.end.position - Vector2d(1.6, 0.5)).norm(), 0.015);
  EXPECT_GE(end.clear_m, options.radius_m - 2 * grid.cell_m) << "cells are turned, so a cell more";
}

TEST(Plan, GridPathIsTheFastestOnItsGraphAndKeepsClear) {
  const PlanOptions options;
  const auto astar = make_grid_planner(), exhaustive = make_grid_planner(Search::exhaustive);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const Task task = task_of(seed);
    const Planned fast = planned(*astar, task.grid, task.start, task.goal);
    const Planned all = planned(*exhaustive, task.grid, task.start, task.goal);
    ASSERT_EQ(fast.index(), all.index());
    if (!std::holds_alternative<Path>(fast)) continue;
    ++found;
    const Path path = path_of(fast), judge = path_of(all);
    EXPECT_NEAR(path.searched_seconds, judge.searched_seconds, 1e-3 * judge.searched_seconds);
    EXPECT_LE(path.seconds, judge.searched_seconds + 0.5);
    EXPECT_LT(path.expanded, judge.expanded);
    expect_valid(task, path, options);
  }
  EXPECT_GT(found, 25);
}

TEST_P(EachPlanner, NonsenseIsRefused) {
  const auto why = [&](const Grid& grid, const Pose& start, const Goal& goal,
                       const PlanOptions& o = {}) {
    const auto result = planner_->plan(grid, start, goal, o);
    return result ? std::string("planned") : result.error().message;
  };
  const Grid grid = floor_grid();
  EXPECT_NE(why({}, {}, {}).find("at least one cell"), std::string::npos);
  EXPECT_NE(why(grid, {{std::nan(""), 0}, 0}, {}).find("not finite"), std::string::npos);
  EXPECT_NE(why(grid, {}, {{0, 0}, std::nan("")}).find("not finite"), std::string::npos);
  PlanOptions options;
  options.turn_s_per_rad = 0;
  EXPECT_NE(why(grid, {}, {}, options).find("above 0"), std::string::npos);
}

TEST(ForgetSpecks, LeavesWhatIsLargeOrNear) {
  Grid grid;
  grid.cells_x = grid.cells_y = 100;
  grid.state.assign(10000, map::CellState::floor);
  const auto block = [&](int x, int y) { grid.state[grid.index(x, y)] = map::CellState::obstacle; };
  for (int i = 0; i < 3; ++i) block(80 + i, 80 + i);  // three cells, by their corners
  for (int i = 0; i < 8; ++i) block(80 + i, 20);      // a line of eight
  block(5, 5);                                        // near
  block(99, 99);                                      // at the rim
  forget_specks(grid, 8, {0, 0}, 0.5);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(grid.at(80 + i, 80 + i), map::CellState::unknown);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(grid.at(80 + i, 20), map::CellState::obstacle);
  EXPECT_EQ(grid.at(5, 5), map::CellState::obstacle);
  EXPECT_EQ(grid.at(99, 99), map::CellState::unknown);
}

}  // namespace
}  // namespace kaz::plan
