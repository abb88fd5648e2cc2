// Benchmark: one stereo pair through the whole vision pipeline into the map, on one core.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>

#include <cmath>

#include "host/map/local_map.h"
#include "vision/depth/stereo_testing.h"
#include "vision/image/pictures_testing.h"
#include "vision/pipeline/modules.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::map {
namespace {

// Of test_room(): 0.3 m above the floor, 0.6 rad below the horizon.
Eigen::Isometry3d room_eye() {
  const Eigen::Vector3d down(0, std::cos(0.6), std::sin(0.6)),
      ahead(0, -std::sin(0.6), std::cos(0.6));
  Eigen::Isometry3d foot_from_eye = Eigen::Isometry3d::Identity();
  foot_from_eye.linear().row(0) = ahead.transpose();
  foot_from_eye.linear().row(1) = -Eigen::RowVector3d::UnitX();
  foot_from_eye.linear().row(2) = -down.transpose();
  foot_from_eye.translation().z() = 0.3;
  return foot_from_eye;
}

// Colour and ball, depth, planes, the floor's edges, flow, independent motion, and the map; all threads
// counted.
void whole(benchmark::State& state, int width) {
  cv::setNumThreads(1);
  const vision::CameraModel camera = vision::test_camera(width, width * 3 / 4);
  std::vector<std::shared_ptr<const vision::StereoImages>> pairs;
  for (std::uint64_t i = 0; i < 4; ++i) {
    auto pair =
        std::make_shared<vision::StereoImages>(vision::test_room().pictures(camera, 2, 5 + i));
    vision::paint_sphere(pair->left, camera, {0.03 + 0.002 * static_cast<double>(i), 0.02, 0.35},
                         0.020, vision::kTestRed);
    pairs.push_back(std::move(pair));
  }
  vision::Pipeline pipeline({vision::Pace::lockstep, Time(0)});
  auto map = LocalMap::make();
  auto ready = pipeline.add(vision::make_color_module({}));
  if (ready) ready = pipeline.add(vision::make_depth_module({}));
  if (ready) ready = pipeline.add(vision::make_flow_module({}));
  if (ready) ready = pipeline.add(vision::make_planes_module({}));
  if (ready) ready = pipeline.add(vision::make_floor_module({}));
  if (ready) ready = pipeline.add(vision::make_independent_motion_module({}));
  int entered = 0, moved = 0;
  if (ready)
    ready = pipeline.subscribe<vision::PlaneSegments>(
        "floor", [&](const vision::Frame& frame, const auto* planes, const Error*) {
          if (planes == nullptr || !map) return;
          entered +=
              map->update(*planes, frame.of<vision::DepthImage>("depth"), frame.info()) ? 1 : 0;
        });
  if (ready)
    ready = pipeline.subscribe<vision::MovingRegions>(
        "moving", [&](const vision::Frame&, const auto* moving, const Error*) {
          moved += moving != nullptr ? 1 : 0;
        });
  std::uint64_t frames = 0;
  for (auto _ : state) {
    vision::StereoPair pair;
    pair.info = vision::test_info(camera);
    pair.info.posture_known = true;
    pair.info.foot_from_eye = room_eye();
    pair.info.sequence = ++frames;
    pair.info.exposure = std::chrono::milliseconds(33 * frames);
    std::promise<std::shared_ptr<const vision::StereoImages>> pixels;
    pixels.set_value(pairs[frames % pairs.size()]);
    pair.images = pixels.get_future().share();
    pipeline.submit(std::move(pair));
    pipeline.poll(Time::max());
  }
  if (!ready || static_cast<std::uint64_t>(entered) != frames)
    state.SkipWithError("a picture did not reach the map");
  if (static_cast<std::uint64_t>(moved) != frames)
    state.SkipWithError("the detection of independent motion failed on a picture");
}

BENCHMARK_CAPTURE(whole, 320, 320)
    ->Name("vision.pipeline_ms.320")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(whole, 640, 640)
    ->Name("vision.pipeline_ms.640")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace kaz::map
