// Planning: known answers, the exhaustive search as judge, and outlines by brute force.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/plan.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "host/plan/grid_planner.h"
#include "host/plan/maps_testing.h"
#include "host/plan/ompl_planner.h"

namespace kaz::plan {
namespace {

using Eigen::Vector2d;
using map::CellState;

constexpr double kPi = std::numbers::pi;

Planned planned(Planner& planner, const Grid& grid, const Pose& start, const Goal& goal,
                const PlanOptions& options = {}) {
  auto result = planner.plan(grid, start, goal, options);
  EXPECT_TRUE(result) << result.error().message;
  return *result;
}

// Those of this build.
std::vector<std::string> planners() {
  std::vector<std::string> names{"grid"};
  if (make_ompl_planner()) names.emplace_back("ompl");
  return names;
}

class EachPlanner : public testing::TestWithParam<std::string> {
 protected:
  Planned planned(const Grid& grid, const Pose& start, const Goal& goal,
                  const PlanOptions& options = {}) {
    return plan::planned(*planner_, grid, start, goal, options);
  }
  std::unique_ptr<Planner> planner_ =
      GetParam() == "ompl" ? std::move(*make_ompl_planner()) : make_grid_planner();
};
INSTANTIATE_TEST_SUITE_P(Plan, EachPlanner, testing::ValuesIn(planners()),
                         [](const auto& planner) { return planner.param; });

Path path_of(const Planned& found, const PlanOptions& options = {}) {
  if (const auto* none = std::get_if<NoPath>(&found)) {
    ADD_FAILURE() << text(*none, options);
    return {};
  }
  return std::get<Path>(found);
}

// Where the legs lead to, and the least distance of the way from an obstacle's square, m.
struct Walked {
  Pose end;
  double clear_m = 1e9;
};
Walked walked(const Grid& grid, const Pose& start, const Path& path) {
  std::vector<Vector2d> obstacles;
  for (int x = 0; x < grid.cells_x; ++x)
    for (int y = 0; y < grid.cells_y; ++y)
      if (grid.at(x, y) == CellState::obstacle) obstacles.push_back(grid.middle(x, y));
  Walked w{start};
  const auto look = [&] {
    for (const Vector2d& middle : obstacles) {
      const Vector2d beyond =
          ((w.end.position - middle).cwiseAbs().array() - 0.5 * grid.cell_m).max(0).matrix();
      w.clear_m = std::min(w.clear_m, beyond.norm());
    }
  };
  look();
  for (const Leg& leg : path.legs) {
    if (leg.kind == Leg::Kind::turn) {
      w.end.heading_rad += leg.amount;
      continue;
    }
    const int steps = static_cast<int>(std::ceil(leg.amount / 0.004));
    for (int i = 0; i < steps; ++i) {
      w.end.position +=
          leg.amount / steps * Vector2d(std::cos(w.end.heading_rad), std::sin(w.end.heading_rad));
      look();
    }
  }
  return w;
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
  EXPECT_EQ(why({0.3, 0}, {1.25, 0.12}),
            "the goal is 0.07 m from an obstacle at (1.255, 0.205); the robot needs 0.16 m");
  EXPECT_EQ(why({1.25, 0.12}, {0.3, 0}),
            "the robot is 0.07 m from an obstacle at (1.255, 0.205); it needs 0.16 m to turn");
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

// Start, goal and map: boxes by `seed`, every other goal with a heading.
struct Task {
  Pose start;
  Goal goal;
  Grid grid;
};
Task task_of(std::uint64_t seed) {
  Task task;
  task.start = {{0.25, -0.6}, 6 * Random(1000 + seed).uniform()};
  task.goal = {{1.7, 0.6}, seed % 2 ? std::optional<double>(1.0) : std::nullopt};
  Random random(seed);
  task.grid = random_grid(random, task.start.position, task.goal.position);
  return task;
}

// Walked by brute force: it ends where it shall, and nothing is nearer than allowed, up to a cell.
void expect_valid(const Task& task, const Path& path, const PlanOptions& options) {
  const Walked end = walked(task.grid, task.start, path);
  EXPECT_LT((end.end.position - task.goal.position).norm(), 1e-6);
  if (task.goal.heading_rad) {
    EXPECT_NEAR(std::remainder(end.end.heading_rad - *task.goal.heading_rad, 2 * kPi), 0, 1e-6);
  }
  EXPECT_GE(end.clear_m, options.radius_m - task.grid.cell_m);
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

TEST(Plan, OmplPathIsNearlyTheFastestAndKeepsClear) {
  auto ompl = make_ompl_planner();
  if (!ompl) GTEST_SKIP() << ompl.error().message;
  const auto exhaustive = make_grid_planner(Search::exhaustive);
  for (const double disc : {PlanOptions{}.radius_m, 0.19}) {
    PlanOptions options;
    options.radius_m = disc;
    std::vector<double> over;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(seed);
      const Task task = task_of(seed);
      const Planned found = planned(**ompl, task.grid, task.start, task.goal, options);
      const Planned all = planned(*exhaustive, task.grid, task.start, task.goal, options);
      ASSERT_EQ(found.index(), all.index());
      if (const auto* none = std::get_if<NoPath>(&found)) {
        EXPECT_EQ(text(*none, options), text(std::get<NoPath>(all), options));
        continue;
      }
      const Path path = path_of(found);
      EXPECT_LE(path.seconds, path.searched_seconds + 1e-6) << "straight lines made it slower";
      over.push_back(path.seconds / path_of(all).searched_seconds);
      EXPECT_LE(over.back(), 1.2);
      expect_valid(task, path, options);
    }
    ASSERT_GT(over.size(), 10u);
    std::ranges::sort(over);
    EXPECT_LE(over[over.size() / 2], 1.02);
  }
}

TEST(Plan, OmplPathDependsOnItsSeedAlone) {
  if (!make_ompl_planner()) GTEST_SKIP() << make_ompl_planner().error().message;
  const auto corners = [](Planner& planner, std::uint64_t task_seed) {
    const Task task = task_of(task_seed);
    return path_of(planned(planner, task.grid, task.start, task.goal)).corners;
  };
  const auto with_seed = [](std::uint64_t seed) {
    return std::move(*make_ompl_planner({.seed = seed}));
  };
  const auto first = with_seed(7);
  const auto path = corners(*first, 3);
  corners(*first, 4);
  EXPECT_EQ(corners(*first, 3), path) << "after another path";
  EXPECT_EQ(corners(*with_seed(7), 3), path) << "by another planner";
  EXPECT_NE(corners(*with_seed(8), 3), path);
}

TEST(Plan, OmplRefusesWhatItCannotDo) {
  auto ompl = make_ompl_planner();
  if (!ompl) GTEST_SKIP() << ompl.error().message;
  PlanOptions options;
  options.any_heading = false;
  const auto result = (*ompl)->plan(floor_grid(), {{0.3, 0}, 0}, {{1, 0}, {}}, options);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().fault, Fault::usage);
  EXPECT_NE(result.error().message.find("45 degrees"), std::string::npos);
  EXPECT_FALSE(make_ompl_planner({.batches = 0}));
}

// Too few samples for a gap: neither no way at all nor an error, and OMPL prints nothing of it.
TEST(Plan, OmplSaysThatItFoundNoPathWhereThereIsOne) {
  auto ompl = make_ompl_planner({.batches = 1, .batches_until_found = 1, .batch_size = 1});
  if (!ompl) GTEST_SKIP() << ompl.error().message;
  Grid grid = floor_grid();
  fill(grid, {0.6, -1}, {0.7, 0.6}, CellState::obstacle);
  fill(grid, {1.3, -0.6}, {1.4, 1}, CellState::obstacle);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const Planned none = planned(**ompl, grid, {{0.3, -0.5}, 0}, {{1.7, 0.5}, {}});
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
  ASSERT_TRUE(std::holds_alternative<NoPath>(none));
  EXPECT_EQ(std::get<NoPath>(none).why, NoPath::Why::not_found);
  EXPECT_NE(text(std::get<NoPath>(none), {}).find("in the samples allowed"), std::string::npos);
}

TEST_P(EachPlanner, NonsenseIsRefused) {
  const auto why = [&](const Grid& grid, const Pose& start, const Goal& goal,
                       const PlanOptions& o = {}) {
    const auto result = planner_->plan(grid, start, goal, o);
    return result ? std::string("planned") : result.error().message;
  };
  const Grid grid = floor_grid();
  EXPECT_NE(why({}, {}, {}).find("no cells"), std::string::npos);
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
