// Time of a stereo pair.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include "sim/view/test_scenes.h"

namespace kaz::sim {
namespace {

// Something moves in every pair, so that the shadow map is drawn as in the running world.
void pair(benchmark::State& state, int width) {
  TestScene s = table_scene();
  const auto renderer = std::move(*make_osmesa_renderer());
  if (!renderer->set_scene(s.scene)) state.SkipWithError("the scene was refused");
  View left = eye_view(width), right = left;
  right.world_from_optical.translate(Eigen::Vector3d(EyeRig().baseline_m(), 0, 0));
  Picture picture;
  if (!renderer->render(s.pose, left, picture)) state.SkipWithError("OpenGL did not start");
  for (auto _ : state) {
    s.pose.frames.back().translation().x() += 1e-5;
    if (!renderer->render(s.pose, left, picture) || !renderer->render(s.pose, right, picture)) {
      state.SkipWithError("a picture failed");
    }
  }
}

BENCHMARK_CAPTURE(pair, 320, 320)->Name("view.pair_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pair, 640, 640)->Name("view.pair_ms.640")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kaz::sim
