// Time that one picture takes to enter the map, and that the floor's edges take, on one core.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include "host/map/view_testing.h"
#include "vision/planes/floor_edges.h"

namespace kaz::map {
namespace {

// Two boxes and a wall, a picture as from the robot's height.
void enter(benchmark::State& state, int width) {
  const TestYard yard{{{{0.50, 0.05, 0.05}, {0.10, 0.20, 0.10}},
                       {{0.70, -0.25, 0.04}, {0.10, 0.10, 0.08}},
                       {{1.30, 0.00, 0.50}, {0.02, 4.00, 1.00}}}};
  TestView view = yard.seen(test_eye(0.1, 0.5), 0.15, 1, width);
  auto map = LocalMap::make();
  for (auto _ : state) {
    view.depth.info.exposure += Time(1);
    view.planes.info.exposure += Time(1);
    if (!map || !map->update(view.planes, view.depth, view.depth.info))
      state.SkipWithError("the picture was refused");
  }
}

// The floor's edges alone, in the same view.
void edges(benchmark::State& state, int width) {
  const TestYard yard{{{{0.50, 0.05, 0.05}, {0.10, 0.20, 0.10}},
                       {{0.70, -0.25, 0.04}, {0.10, 0.10, 0.08}},
                       {{1.30, 0.00, 0.50}, {0.02, 4.00, 1.00}}}};
  const TestView view = yard.seen(test_eye(0.1, 0.5), 0.15, 1, width);
  vision::Image image{width, view.depth.height, {}};
  for (std::size_t k = 0; k < view.planes.label.size(); ++k) {
    const double grey = (view.planes.label[k] == 1 ? 140 : 80) + 8 * keyed_normal(5, 1, k);
    image.rgb.insert(image.rgb.end(), 3, static_cast<std::uint8_t>(grey));
  }
  vision::FloorEdges finder;
  vision::PlaneSegments planes;
  for (auto _ : state) {
    planes = view.planes;
    if (!finder.sharpen(image, planes, &view.depth)) state.SkipWithError("the picture was refused");
  }
}

BENCHMARK_CAPTURE(edges, 320, 320)->Name("vision.edges_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(edges, 640, 640)->Name("vision.edges_ms.640")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(enter, 320, 320)->Name("vision.map_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(enter, 640, 640)->Name("vision.map_ms.640")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kaz::map
