// Times of colour extraction, regions and the whole ball detector.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include "vision/ball.h"
#include "vision/test_pictures.h"

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

BENCHMARK_CAPTURE(color, 320, 320)->Name("vision.color_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(color, 640, 640)->Name("vision.color_ms.640")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(regions, 320, 320)->Name("vision.regions_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(regions, 640, 640)->Name("vision.regions_ms.640")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ball, 320, 320)->Name("vision.ball_ms.320")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ball, 640, 640)->Name("vision.ball_ms.640")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kaz::vision
