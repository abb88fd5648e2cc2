// The planner of OMPL: what every planner does, the exhaustive search as judge, and its seed.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/ompl_planner.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/plan/grid_planner.h"
#include "host/plan/plan_testing.h"

namespace kaz::plan {
namespace {

using map::CellState;

INSTANTIATE_TEST_SUITE_P(Ompl, EachPlanner,
                         testing::Values([] { return make_ompl_planner().value(); }));

TEST(OmplPlanner, PathIsNearlyTheFastestAndKeepsClear) {
  auto ompl = make_ompl_planner();
  ASSERT_TRUE(ompl) << ompl.error().message;
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

TEST(OmplPlanner, PathDependsOnItsSeedAlone) {
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

TEST(OmplPlanner, RefusesWhatItCannotDo) {
  auto ompl = make_ompl_planner();
  ASSERT_TRUE(ompl) << ompl.error().message;
  PlanOptions options;
  options.any_heading = false;
  const auto result = (*ompl)->plan(floor_grid(), {{0.3, 0}, 0}, {{1, 0}, {}}, options);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().fault, Fault::usage);
  EXPECT_NE(result.error().message.find("45 degrees"), std::string::npos);
  EXPECT_FALSE(make_ompl_planner({.batches = 0}));
}

// Too few samples for a gap: neither no way at all nor an error, and OMPL prints nothing of it.
TEST(OmplPlanner, SaysThatItFoundNoPathWhereThereIsOne) {
  auto ompl = make_ompl_planner({.batches = 1, .batches_until_found = 1, .batch_size = 1});
  ASSERT_TRUE(ompl) << ompl.error().message;
  Grid grid = floor_grid();
  fill(grid, {0.6, -1}, {0.7, 0.6}, CellState::obstacle);
  fill(grid, {1.3, -0.6}, {1.4, 1}, CellState::obstacle);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const Planned none = planned(**ompl, grid, {{0.3, -0.5}, 0}, {{1.7, 0.5}, {}});
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
  ASSERT_TRUE(std::holds_alternative<NoPath>(none));
  EXPECT_EQ(std::get<NoPath>(none).why, NoPath::Why::not_found);
  EXPECT_NE(text(std::get<NoPath>(none), {}).find("within its sample limit"), std::string::npos);
}

}  // namespace
}  // namespace kaz::plan
