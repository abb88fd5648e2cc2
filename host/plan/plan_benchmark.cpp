// plan_benchmark [MAPS]: both planners on the same random maps: CPU time, and paths beside the fastest.
// plan_benchmark --json [MAPS]: the same as JSON, with the default disc only.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include <nlohmann/json.hpp>

#include "host/plan/grid_planner.h"
#include "host/plan/maps_testing.h"
#include "host/plan/ompl_planner.h"

namespace kaz::plan {
namespace {

constexpr double kNavigateDisc = 0.19;  // m: kWiderDiscs of navigate.cpp

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

// Sorted values by the share of them that is lower.
double at(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  const auto n = static_cast<double>(sorted.size());
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * n))];
}

constexpr double kMayBeOver = 5;  // %

struct Tried {
  std::string name;  // as --set planner
  std::unique_ptr<Planner> planner;
  std::vector<double> ms = {}, over = {};  // over: % of the exhaustive search's time
  int not_found = 0;                       // paths that there are

  auto too_slow() const {
    return std::ranges::count_if(over, [](double percent) { return percent > kMayBeOver; });
  }
};

// A task with start and goal in the middles of any cells, from where and to where the exhaustive search goes:
// with ends anywhere in their cells it solves another task, as turns to a start a few millimetres beside the
// way cost seconds. Half of the goals have a heading.
struct Task {
  Pose start;
  Goal goal;
  Grid grid;
};
Task random_task(int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  const auto draw = [&](double low, double high) { return low + (high - low) * random.uniform(); };
  Task task;
  task.start.position.x() = draw(0.1, 1.9);
  task.start.position.y() = draw(-0.9, 0.9);
  task.start.heading_rad = draw(-3.1, 3.1);
  task.goal.position.x() = draw(0.1, 1.9);
  task.goal.position.y() = draw(-0.9, 0.9);
  const auto to_middle = [grid = floor_grid()](Eigen::Vector2d& p) {
    const Eigen::Vector2i cell = grid.cell(p);
    p = grid.middle(cell.x(), cell.y());
  };
  to_middle(task.start.position);
  to_middle(task.goal.position);
  if (seed % 2 != 0) task.goal.heading_rad = draw(-3.1, 3.1);
  task.grid = random_grid(random, task.start.position, task.goal.position);
  return task;
}

Result<std::vector<Tried>> measure(const PlanOptions& options, int maps, int* without) {
  std::vector<Tried> all;
  all.push_back({"grid", make_grid_planner()});
  // A build without OMPL measures the grid planner alone.
  if (auto ompl = make_ompl_planner()) all.push_back({"ompl", std::move(*ompl)});
  const auto judge = make_grid_planner(Search::exhaustive);
  *without = 0;
  for (int seed = 1; seed <= maps; ++seed) {
    const Task task = random_task(seed);
    const auto fastest = KAZ_TRY(judge->plan(task.grid, task.start, task.goal, options));
    const auto* path = std::get_if<Path>(&fastest);
    if (path == nullptr) ++*without;
    for (Tried& tried : all) {
      const double before = cpu_ms();
      const auto found = tried.planner->plan(task.grid, task.start, task.goal, options);
      tried.ms.push_back(cpu_ms() - before);
      if (!found) return tl::unexpected(found.error());
      const auto* own = std::get_if<Path>(&*found);
      if (path != nullptr && own == nullptr) ++tried.not_found;
      if (path != nullptr && own != nullptr && path->searched_seconds > 0)
        tried.over.push_back(100 * (own->seconds / path->searched_seconds - 1));
    }
  }
  for (Tried& tried : all) {
    std::ranges::sort(tried.ms);
    std::ranges::sort(tried.over);
  }
  return all;
}

Result<void> table(int maps) {
  for (const double disc : {PlanOptions{}.radius_m, kNavigateDisc}) {
    PlanOptions options;
    options.radius_m = disc;
    int without = 0;
    const auto all = KAZ_TRY(measure(options, maps, &without));
    std::printf("disc radius %.2f m: %d maps, %d of them without a path\n", disc, maps, without);
    std::printf(
        "| planner | ms: median | 90 %% | 99 %% | worst "
        "| over the fastest, %%: median | 99 %% | worst | more than %.0f %% | not found |\n",
        kMayBeOver);
    for (const Tried& tried : all) {
      std::printf("| %s | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %td of %zu | %d |\n",
                  tried.name.c_str(), at(tried.ms, 0.5), at(tried.ms, 0.9), at(tried.ms, 0.99),
                  tried.ms.back(), at(tried.over, 0.5), at(tried.over, 0.99),
                  tried.over.empty() ? 0 : tried.over.back(), tried.too_slow(), tried.over.size(),
                  tried.not_found);
    }
  }
  return {};
}

Result<void> json(int maps) {
  int without = 0;
  nlohmann::ordered_json result;
  for (const Tried& tried : KAZ_TRY(measure({}, maps, &without)))
    result[tried.name] = {{"median_ms", at(tried.ms, 0.5)},
                          {"p99_ms", at(tried.ms, 0.99)},
                          {"over_percent", at(tried.over, 0.99)},
                          {"not_found", tried.not_found}};
  std::printf("%s\n", result.dump(2).c_str());
  return {};
}

}  // namespace
}  // namespace kaz::plan

int main(int count, char** arguments) {
  const bool as_json = count > 1 && std::strcmp(arguments[1], "--json") == 0;
  const int first = as_json ? 2 : 1;
  const int maps = count > first ? std::atoi(arguments[first]) : 1000;
  if (count > first + 1 || maps < 1) {
    std::fprintf(stderr, "usage: plan_benchmark [--json] [MAPS]   MAPS: above 0 (default: 1000)\n");
    return 2;
  }
  const auto done = as_json ? kaz::plan::json(maps) : kaz::plan::table(maps);
  if (done) return 0;
  std::fprintf(stderr, "plan_benchmark: %s\n", done.error().message.c_str());
  return static_cast<int>(done.error().fault);
}
