// Test support for planners: tasks, and a brute-force check of paths.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "host/plan/maps_testing.h"
#include "host/plan/plan.h"

namespace kaz::plan {

inline Planned planned(Planner& planner, const Grid& grid, const Pose& start, const Goal& goal,
                       const PlanOptions& options = {}) {
  auto result = planner.plan(grid, start, goal, options);
  EXPECT_TRUE(result) << result.error().message;
  return *result;
}

// Tests that every planner must pass. The tests are instantiated for each planner.
class EachPlanner : public testing::TestWithParam<std::function<std::unique_ptr<Planner>()>> {
 protected:
  Planned planned(const Grid& grid, const Pose& start, const Goal& goal,
                  const PlanOptions& options = {}) {
    return plan::planned(*planner_, grid, start, goal, options);
  }
  std::unique_ptr<Planner> planner_ = GetParam()();
};

inline Path path_of(const Planned& found, const PlanOptions& options = {}) {
  if (const auto* none = std::get_if<NoPath>(&found)) {
    ADD_FAILURE() << text(*none, options);
    return {};
  }
  return std::get<Path>(found);
}

// Pose at the end of the path, and the smallest distance (m) between the path and an obstacle cell.
struct Walked {
  Pose end;
  double clear_m = 1e9;
};
inline Walked walked(const Grid& grid, const Pose& start, const Path& path) {
  std::vector<Eigen::Vector2d> obstacles;
  for (int x = 0; x < grid.cells_x; ++x)
    for (int y = 0; y < grid.cells_y; ++y)
      if (grid.at(x, y) == map::CellState::obstacle) obstacles.push_back(grid.middle(x, y));
  Walked w{start};
  const auto look = [&] {
    for (const Eigen::Vector2d& middle : obstacles) {
      const Eigen::Vector2d beyond =
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
      w.end.position += leg.amount / steps *
                        Eigen::Vector2d(std::cos(w.end.heading_rad), std::sin(w.end.heading_rad));
      look();
    }
  }
  return w;
}

// Start, goal and a map of random boxes. The goal has a heading if the seed is odd.
struct Task {
  Pose start;
  Goal goal;
  Grid grid;
};
inline Task task_of(std::uint64_t seed) {
  Task task;
  task.start = {{0.25, -0.6}, 6 * Random(1000 + seed).uniform()};
  task.goal = {{1.7, 0.6}, seed % 2 ? std::optional<double>(1.0) : std::nullopt};
  Random random(seed);
  task.grid = random_grid(random, task.start.position, task.goal.position);
  return task;
}

// Checks that the path ends at the goal and that no obstacle is nearer than allowed, with a tolerance of one
// cell.
inline void expect_valid(const Task& task, const Path& path, const PlanOptions& options) {
  const Walked end = walked(task.grid, task.start, path);
  EXPECT_LT((end.end.position - task.goal.position).norm(), 1e-6);
  if (task.goal.heading_rad) {
    EXPECT_NEAR(std::remainder(end.end.heading_rad - *task.goal.heading_rad, 2 * std::numbers::pi),
                0, 1e-6);
  }
  EXPECT_GE(end.clear_m, options.radius_m - task.grid.cell_m);
}

}  // namespace kaz::plan
