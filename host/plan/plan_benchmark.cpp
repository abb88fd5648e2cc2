// plan_benchmark [MAPS]: CPU time of paths in random maps, by the shares that take longer.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "host/plan/grid_planner.h"
#include "host/plan/maps_testing.h"

namespace kaz::plan {
namespace {

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

int measure(int maps) {
  const auto planner = make_grid_planner();
  std::vector<double> ms;
  int without = 0;
  for (int seed = 1; seed <= maps; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const auto draw = [&](double low, double high) {
      return low + (high - low) * random.uniform();
    };
    Pose start;
    start.position.x() = draw(0.1, 1.9);
    start.position.y() = draw(-0.9, 0.9);
    start.heading_rad = draw(-3.1, 3.1);
    Goal goal;
    goal.position.x() = draw(0.1, 1.9);
    goal.position.y() = draw(-0.9, 0.9);
    if (seed % 2 != 0) goal.heading_rad = draw(-3.1, 3.1);
    const Grid grid = random_grid(random, start.position, goal.position);
    const double before = cpu_ms();
    const auto found = planner->plan(grid, start, goal, {});
    ms.push_back(cpu_ms() - before);
    if (!found) {
      std::fprintf(stderr, "plan_benchmark: map %d: %s\n", seed, found.error().message.c_str());
      return 1;
    }
    without += std::holds_alternative<NoPath>(*found) ? 1 : 0;
  }
  std::ranges::sort(ms);
  const auto share = [&](double of) {
    return ms[std::min(ms.size() - 1,
                       static_cast<std::size_t>(of * static_cast<double>(ms.size())))];
  };
  std::printf(
      "%d maps, %d of them without a path; ms: median %.2f, 90 %% %.2f, 99 %% %.2f, worst %.2f\n",
      maps, without, share(0.5), share(0.9), share(0.99), ms.back());
  return 0;
}

}  // namespace
}  // namespace kaz::plan

int main(int count, char** arguments) {
  const int maps = count > 1 ? std::atoi(arguments[1]) : 1000;
  if (count > 2 || maps < 1) {
    std::fprintf(stderr, "usage: plan_benchmark [MAPS]   a number above 0; 1000 without it\n");
    return 2;
  }
  return kaz::plan::measure(maps);
}
