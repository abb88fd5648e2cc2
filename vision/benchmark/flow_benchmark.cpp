// Times of flow on one core; peer.* is OpenCV's by itself, in the same run.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

#include "vision/depth/stereo_testing.h"
#include "vision/flow/flow.h"
#include "vision/flow/independent_motion.h"

namespace kaz::vision {
namespace {

// A room from two eyes a step to the side apart, as an eye in motion sees it: grey, with noise.
struct Pair {
  CameraModel camera;
  std::vector<std::uint8_t> pixels[2];
  FrameInfo info[2];

  explicit Pair(int width) : camera(test_camera(width, width * 3 / 4)) {
    cv::setNumThreads(1);
    CameraModel step = camera;
    step.baseline_m = 0.008;
    const StereoImages pair = test_room().pictures(step, 2, 5);
    const Image* const images[] = {&pair.left, &pair.right};
    for (int i = 0; i < 2; ++i) {
      for (std::size_t k = 0; k < images[i]->rgb.size(); k += 3)
        pixels[i].push_back(images[i]->rgb[k]);
      info[i] = test_info(camera);
      info[i].exposure = std::chrono::milliseconds(33 * i);
    }
  }
  GreyPicture picture(int i) const { return {camera.width, camera.height, pixels[i]}; }
};

void flow(benchmark::State& state, int width) {
  const Pair pair(width);
  FlowFinder finder;
  FlowImage image;
  for (auto _ : state) {
    if (!finder.find(pair.picture(0), pair.info[0], pair.picture(1), pair.info[1], image))
      state.SkipWithError("no flow");
  }
  std::size_t known = 0;
  for (const auto& f : image.flow_px) known += !std::isnan(f.x());
  state.counters["known"] = static_cast<double>(known) / static_cast<double>(image.flow_px.size());
}

// After the flow; nothing moves, and depth is not known but by the floor.
void moving(benchmark::State& state, int width) {
  Pair pair(width);
  for (FrameInfo& info : pair.info) info.posture_known = true;
  pair.info[1].foot_from_eye = pair.info[0].foot_from_eye * Eigen::Translation3d(0.008, 0, 0);
  FlowFinder flows;
  FlowImage image;
  if (!flows.find(pair.picture(0), pair.info[0], pair.picture(1), pair.info[1], image))
    return state.SkipWithError("no flow");
  IndependentMotionDetector finder;
  MovingRegions found;
  for (auto _ : state) {
    if (!finder.find(image, pair.picture(0), pair.picture(1), nullptr, found))
      state.SkipWithError("no result");
  }
  state.counters["regions"] = static_cast<double>(found.regions.size());
}

void peer(benchmark::State& state, int width) {
  const Pair pair(width);
  cv::Mat grey[2], found;
  for (int i = 0; i < 2; ++i)
    grey[i] = cv::Mat(pair.camera.height, pair.camera.width, CV_8UC1,
                      const_cast<std::uint8_t*>(pair.pixels[i].data()))
                  .clone();
  const auto search = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST);
  for (auto _ : state) {
    found.release();
    search->calc(grey[0], grey[1], found);
  }
}

#define KAZ_SIZES(run, name)                                                          \
  BENCHMARK_CAPTURE(run, 320, 320)->Name(name ".320")->Unit(benchmark::kMillisecond); \
  BENCHMARK_CAPTURE(run, 640, 640)->Name(name ".640")->Unit(benchmark::kMillisecond)
KAZ_SIZES(flow, "vision.flow_ms");
KAZ_SIZES(peer, "peer.opencv_dis_ms");
KAZ_SIZES(moving, "vision.moving_ms");

}  // namespace
}  // namespace kaz::vision
