// Times of vision's parts on one core; peer.* is what stands beside them, in the same run.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/benchmark/corner_scene.h"
#include "vision/color/ball.h"
#include "vision/depth/depth.h"
#include "vision/depth/stereo_testing.h"
#include "vision/image/pictures_testing.h"
#include "vision/planes/plane_segments.h"

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

enum class PeerColor { yuv, hsv };

// OpenCV's colour space and a box in it: six comparisons a pixel as ours, though not of a cone.
void peer_color(benchmark::State& state, int width, PeerColor space) {
  cv::setNumThreads(1);
  Image image = bench_picture(test_camera(width, width * 3 / 4));
  const cv::Mat rgb(image.height, image.width, CV_8UC3, image.rgb.data());
  const bool hsv = space == PeerColor::hsv;
  cv::Mat other, mask;
  for (auto _ : state) {
    cv::cvtColor(rgb, other, hsv ? cv::COLOR_RGB2HSV : cv::COLOR_RGB2YUV);
    cv::inRange(other, hsv ? cv::Scalar(0, 120, 40) : cv::Scalar(14, 40, 140),
                hsv ? cv::Scalar(12, 255, 255) : cv::Scalar(255, 120, 255), mask);
  }
  state.counters["set"] = cv::countNonZero(mask);
}

void regions(benchmark::State& state, int width) {
  const Image image = bench_picture(test_camera(width, width * 3 / 4));
  Mask mask;
  ColorExtractor(ColorRange::red_ball()).extract(image, mask);
  RegionFinder finder;
  for (auto _ : state) benchmark::DoNotOptimize(finder.find(mask, 9).data());
}

void peer_regions(benchmark::State& state, int width) {
  cv::setNumThreads(1);
  Mask mask;
  ColorExtractor(ColorRange::red_ball())
      .extract(bench_picture(test_camera(width, width * 3 / 4)), mask);
  const cv::Mat pixels(mask.height, mask.width, CV_8UC1, mask.pixels.data());
  cv::Mat labels, boxes, middles;
  int found = 0;
  for (auto _ : state)
    found = cv::connectedComponentsWithStats(pixels, labels, boxes, middles, 8, CV_32S);
  state.counters["regions"] = found - 1;
}

void ball(benchmark::State& state, int width) {
  const CameraModel camera = test_camera(width, width * 3 / 4);
  const Image image = bench_picture(camera);
  BallFinder detector({});
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

void planes(benchmark::State& state, int width) {
  const DepthImage image = corner_scene(width);
  PlaneSegmentFinder finder;
  PlaneSegments found;
  for (auto _ : state) {
    if (!finder.find(image, found) || found.segments.size() < 3) state.SkipWithError("no planes");
  }
  state.counters["segments"] = static_cast<double>(found.segments.size());
}

#define KAZ_BENCHMARK(name, ...) \
  BENCHMARK_CAPTURE(__VA_ARGS__)->Name(name)->Unit(benchmark::kMillisecond)
KAZ_BENCHMARK("vision.color_ms.320", color, 320, 320);
KAZ_BENCHMARK("peer.opencv_color_ms.yuv.320", peer_color, yuv320, 320, PeerColor::yuv);
KAZ_BENCHMARK("peer.opencv_color_ms.hsv.320", peer_color, hsv320, 320, PeerColor::hsv);
KAZ_BENCHMARK("vision.regions_ms.320", regions, 320, 320);
KAZ_BENCHMARK("peer.opencv_regions_ms.320", peer_regions, 320, 320);
KAZ_BENCHMARK("vision.ball_ms.320", ball, 320, 320);
KAZ_BENCHMARK("vision.depth_ms.320", depth, 320, 320);
KAZ_BENCHMARK("peer.opencv_stereobm_ms.320", peer_depth, 320, 320);
KAZ_BENCHMARK("vision.psf_ms.320", planes, 320, 320);
KAZ_BENCHMARK("vision.color_ms.640", color, 640, 640);
KAZ_BENCHMARK("peer.opencv_color_ms.yuv.640", peer_color, yuv640, 640, PeerColor::yuv);
KAZ_BENCHMARK("peer.opencv_color_ms.hsv.640", peer_color, hsv640, 640, PeerColor::hsv);
KAZ_BENCHMARK("vision.regions_ms.640", regions, 640, 640);
KAZ_BENCHMARK("peer.opencv_regions_ms.640", peer_regions, 640, 640);
KAZ_BENCHMARK("vision.ball_ms.640", ball, 640, 640);
KAZ_BENCHMARK("vision.depth_ms.640", depth, 640, 640);
KAZ_BENCHMARK("peer.opencv_stereobm_ms.640", peer_depth, 640, 640);
KAZ_BENCHMARK("vision.psf_ms.640", planes, 640, 640);
#undef KAZ_BENCHMARK

}  // namespace
}  // namespace kaz::vision
