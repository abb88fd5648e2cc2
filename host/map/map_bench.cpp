// Time that one picture takes to enter the map, on one core.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include "host/map/test_view.h"

namespace kaz::map {
namespace {

// Two boxes and a wall, a picture as from the robot's height.
void enter(benchmark::State& state, int width) {
  const TestYard yard{{{{0.50, 0.05, 0.05}, {0.10, 0.20, 0.10}},
                       {{0.70, -0.25, 0.04}, {0.10, 0.10, 0.08}},
                       {{1.30, 0.00, 0.50}, {0.02, 4.00, 1.00}}}};
  TestSight sight = yard.seen(test_eye(0.1, 0.5), 0.15, 1, width);
  auto map = LocalMap::make();
  for (auto _ : state) {
    sight.depth.info.exposure += Time(1);
    sight.planes.info.exposure += Time(1);
    if (!map || !map->update(sight.planes, sight.depth, sight.depth.info))
      state.SkipWithError("the picture was refused");
  }
}

BENCHMARK_CAPTURE(enter, 320, 320)->Name("vision.map_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(enter, 640, 640)->Name("vision.map_ms.640")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kaz::map
