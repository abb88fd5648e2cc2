// Time of a stereo pair, ideal, and of what the sensor model adds to it.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include "sim/render/renderer_kind.h"
#include "sim/render/scenes_testing.h"
#include "sim/render/sensor/real_eye.h"

namespace kaz::sim {
namespace {

// Something moves in every pair, so that the shadow map is drawn as in the running world.
void pair(benchmark::State& state, int width, RendererKind kind) {
  TestScene s = table_scene();
  const auto renderer = std::move(*maker_of(kind)());
  if (!renderer->set_scene(s.scene)) state.SkipWithError("the scene was refused");
  View left = eye_view(width), right = left;
  right.world_from_optical.translate(Eigen::Vector3d(kEyeBaseline_m, 0, 0));
  vision::Image picture;
  if (!renderer->render(s.pose, left, picture)) state.SkipWithError("the renderer did not start");
  for (auto _ : state) {
    s.pose.frames.back().translation().x() += 1e-5;
    if (!renderer->render(s.pose, left, picture) || !renderer->render(s.pose, right, picture)) {
      state.SkipWithError("a picture failed");
    }
  }
}

// Lens and noise of both eyes, on pictures that are drawn already.
void sensor(benchmark::State& state, int width) {
  EyeModel model;
  model.width = width;
  model.height = width * 3 / 4;
  const auto calibration = make_calibration(model, 1, kEyeBaseline_m);
  const Sensor left(model, calibration, Sensor::Eye::left, 1),
      right(model, calibration, Sensor::Eye::right, 1);
  TestScene s = table_scene();
  const auto renderer = std::move(*maker_of(kDefaultRenderer)());
  View view = eye_view(width);
  vision::Image ideal[2], pictures[2];
  bool drawn = renderer->set_scene(s.scene).has_value();
  for (int i = 0; i < 2 && drawn; ++i) {
    view.camera = (i == 0 ? left : right).ideal();
    drawn = renderer->render(s.pose, view, ideal[i]).has_value();
  }
  if (!drawn) state.SkipWithError("a picture failed");
  std::uint64_t exposure = 0;
  for (auto _ : state) {
    left.expose(ideal[0], exposure, pictures[0]);
    right.expose(ideal[1], exposure++, pictures[1]);
  }
}

// Complete processing of a pair with the sensor model: wider pictures, lens, noise, rectification.
void real_pair(benchmark::State& state, int width, RendererKind kind) {
  EyeModel model;
  model.width = width;
  model.height = width * 3 / 4;
  const auto calibration = make_calibration(model, 1, kEyeBaseline_m);
  RealEye left(model, calibration, Sensor::Eye::left, 1),
      right(model, calibration, Sensor::Eye::right, 1);
  TestScene s = table_scene();
  const auto renderer = std::move(*maker_of(kind)());
  if (!renderer->set_scene(s.scene)) state.SkipWithError("the scene was refused");
  const Eigen::Isometry3d eye = eye_view(width).world_from_optical;
  const View views[2] = {left.view(eye),
                         right.view(eye * Eigen::Translation3d(kEyeBaseline_m, 0, 0))};
  vision::StereoImages rectified;
  std::uint64_t exposure = 0;
  if (!left.take(*renderer, s.pose, views[0], exposure, rectified.left))
    state.SkipWithError("the renderer did not start");
  for (auto _ : state) {
    s.pose.frames.back().translation().x() += 1e-5;
    ++exposure;
    if (!left.take(*renderer, s.pose, views[0], exposure, rectified.left) ||
        !right.take(*renderer, s.pose, views[1], exposure, rectified.right))
      state.SkipWithError("a picture failed");
  }
}

BENCHMARK_CAPTURE(sensor, 320, 320)->Name("view.sensor_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(sensor, 640, 640)->Name("view.sensor_ms.640")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(real_pair, 320, 320, RendererKind::opengl)
    ->Name("view.real_pair_ms.320")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(real_pair, 640, 640, RendererKind::opengl)
    ->Name("view.real_pair_ms.640")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(real_pair, raster_320, 320, RendererKind::raster)
    ->Name("view.real_pair_ms.320.raster")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(real_pair, raster_640, 640, RendererKind::raster)
    ->Name("view.real_pair_ms.640.raster")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pair, 320, 320, RendererKind::opengl)
    ->Name("view.pair_ms.320")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pair, 640, 640, RendererKind::opengl)
    ->Name("view.pair_ms.640")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pair, raster_320, 320, RendererKind::raster)
    ->Name("view.pair_ms.320.raster")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pair, raster_640, 640, RendererKind::raster)
    ->Name("view.pair_ms.640.raster")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kaz::sim
