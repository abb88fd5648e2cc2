// Times of vision's parts on one core; peer.* is what stands beside them, in the same run.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "vision/ball.h"
#include "vision/depth.h"
#include "vision/plane_segments.h"
#include "vision/test_pictures.h"
#include "vision/test_stereo.h"

namespace kaz::vision {
namespace {

// A ball on a ground of two tones, with noise as of a camera.
Image bench_picture(const CameraModel& camera) {
  Image image = plain_picture(camera.width, camera.height, kTestGrey);
  TestRandom random(5);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      std::uint8_t* p = &image.rgb[static_cast<std::size_t>(v * image.width + u) * 3];
      const int tone = (u / 20 + v / 20) % 2 == 0 ? 40 : 0;
      for (int c = 0; c < 3; ++c) p[c] = static_cast<std::uint8_t>(p[c] - tone + random.next() % 7);
    }
  }
  paint_sphere(image, camera, {0.03, 0.02, 0.35}, 0.020, kTestRed);
  return image;
}

void color(benchmark::State& state, int width) {
  const Image image = bench_picture(test_camera(width, width * 3 / 4));
  const ColorExtractor extractor(ColorRange::red_ball());
  Mask mask;
  for (auto _ : state) {
    extractor.extract(image, mask);
    benchmark::DoNotOptimize(mask.pixels.data());
  }
}

void regions(benchmark::State& state, int width) {
  const Image image = bench_picture(test_camera(width, width * 3 / 4));
  Mask mask;
  ColorExtractor(ColorRange::red_ball()).extract(image, mask);
  RegionFinder finder;
  for (auto _ : state) benchmark::DoNotOptimize(finder.find(mask, 9).data());
}

void ball(benchmark::State& state, int width) {
  const CameraModel camera = test_camera(width, width * 3 / 4);
  const Image image = bench_picture(camera);
  BallDetector detector({});
  const FrameInfo info = test_info(camera);
  for (auto _ : state) {
    if (!detector.detect(image, info).found) state.SkipWithError("the ball was not found");
  }
}

void depth(benchmark::State& state, int width) {
  cv::setNumThreads(1);
  const CameraModel camera = test_camera(width, width * 3 / 4);
  const StereoImages pair = test_room().pictures(camera, 2, 5);
  DepthFinder finder;
  DepthImage image;
  const FrameInfo info = test_info(camera);
  for (auto _ : state) {
    if (!finder.find(pair, info, image)) state.SkipWithError("no depth");
  }
}

// StereoBM by itself on grey pictures, with the same block, disparities and left-right check. It
// gives nothing in the columns on the left that the disparities take.
void peer_depth(benchmark::State& state, int width) {
  cv::setNumThreads(1);
  const CameraModel camera = test_camera(width, width * 3 / 4);
  const StereoImages pair = test_room().pictures(camera, 2, 5);
  cv::Mat grey[2], disparity;
  for (const Image* image : {&pair.left, &pair.right}) {
    cv::Mat& g = grey[image == &pair.left ? 0 : 1];
    g.create(image->height, image->width, CV_8UC1);
    for (std::size_t i = 0; i < image->rgb.size() / 3; ++i) g.data[i] = image->rgb[3 * i];
  }
  const int disparities =
      (static_cast<int>(std::ceil(camera.fx * camera.baseline_m / DepthOptions().nearest_m)) + 15) /
      16 * 16;
  const auto matcher = cv::StereoBM::create(disparities, 15);
  matcher->setDisp12MaxDiff(1);
  matcher->setUniquenessRatio(10);
  for (auto _ : state) matcher->compute(grey[0], grey[1], disparity);
}

// Floor, wall, and a box's front and top, with 0.2 px of noise.
void planes(benchmark::State& state, int width) {
  const CameraModel camera = test_camera(width, width * 3 / 4);
  std::vector<int> patch;
  DepthImage image = test_corner().truth(camera, patch);
  for (std::size_t i = 0; i < image.disparity_px.size(); ++i) {
    float& d = image.disparity_px[i];
    if (d > 0) d += static_cast<float>(0.2 * keyed_normal(1, 2, i));
  }
  PlaneSegmentFinder finder;
  PlaneSegments found;
  for (auto _ : state) {
    if (!finder.find(image, found) || found.segments.size() < 3) state.SkipWithError("no planes");
  }
  state.counters["segments"] = static_cast<double>(found.segments.size());
}

BENCHMARK_CAPTURE(color, 320, 320)->Name("vision.color_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(color, 640, 640)->Name("vision.color_ms.640")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(regions, 320, 320)->Name("vision.regions_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(regions, 640, 640)->Name("vision.regions_ms.640")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ball, 320, 320)->Name("vision.ball_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ball, 640, 640)->Name("vision.ball_ms.640")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(depth, 320, 320)->Name("vision.depth_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(peer_depth, 320, 320)
    ->Name("peer.opencv_stereobm_ms.320")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(depth, 640, 640)->Name("vision.depth_ms.640")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(peer_depth, 640, 640)
    ->Name("peer.opencv_stereobm_ms.640")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(planes, 320, 320)->Name("vision.psf_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(planes, 640, 640)->Name("vision.psf_ms.640")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kaz::vision
