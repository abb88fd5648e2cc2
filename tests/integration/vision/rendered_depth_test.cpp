// Depth in pictures of the simulated eyes, with lens, noise and rectification, against the scene.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/integration/vision/rendered_scene_testing.h"
#include "vision/depth/depth.h"

namespace kaz::sim {
namespace {

// What stereo needs: edges across the row. Root mean square of the change from pixel to pixel along
// the row over the block that is matched,
// in codes of the noiseless picture.
double texture_at(const vision::Image& image, int u, int v) {
  double sum = 0;
  for (int y = v - 7; y <= v + 7; ++y) {
    for (int x = u - 7; x < u + 7; ++x) {
      const std::uint8_t* c = &image.rgb[static_cast<std::size_t>(y * image.width + x) * 3];
      const double change = 0.299 * (c[3] - c[0]) + 0.587 * (c[4] - c[1]) + 0.114 * (c[5] - c[2]);
      sum += change * change;
    }
  }
  return std::sqrt(sum / (15 * 14));
}

struct Score {
  int textured = 0, known = 0, good = 0;
  std::vector<double> errors;
  double percentile(double p) const {
    return errors.empty() ? 0 : errors[static_cast<std::size_t>(p * (errors.size() - 1.0))];
  }
};

// Pixels with texture that both eyes see; one without depth counts as wrong.
Score score(const RenderedScene& scene, const vision::Image& ideal,
            const vision::DepthImage& depth) {
  const vision::CameraModel& c = scene.camera();
  Score s;
  for (int v = 8; v < depth.height - 8; ++v) {
    for (int u = 8; u < depth.width - 8; ++u) {
      const double z = scene.truth(u, v).depth_m;
      const double d = z > 0 ? c.fx * c.baseline_m / z : 0;
      if (d <= 0 || u - d < 8 || texture_at(ideal, u, v) < 2 || !scene.seen_by_both(u, v)) continue;
      ++s.textured;
      if (!depth.known(u, v)) continue;
      ++s.known;
      s.errors.push_back(std::abs(depth.disparity(u, v) - d));
      if (s.errors.back() < 0.6) ++s.good;
    }
  }
  std::sort(s.errors.begin(), s.errors.end());
  return s;
}

TEST(RenderedDepth, IsWithinSixTenthsOfAPixelOnTexture) {
  vision::DepthFinder finder;
  vision::DepthImage depth;
  int textured = 0, good = 0;
  for (const int width : {320, 640}) {
    for (const char* floor : {"wood", "carpet", "checker"}) {
      for (const double tilt : {0.35, 0.7}) {
        const RenderedScene scene(width, floor, tilt);
        const auto renderer = scene.renderer();
        const auto found = finder.find(scene.take(*renderer, 1), scene.info(), depth);
        ASSERT_TRUE(found) << found.error().message;
        const Score s = score(scene, scene.ideal_picture(*renderer), depth);
        std::printf(
            "%d px, %-7s, %.2f rad: %6d textured, %5.1f %% within 0.6 px, %5.1f %% known; "
            "error 50 %% %.2f, 90 %% %.2f, 99 %% %.2f px\n",
            width, floor, tilt, s.textured, 100.0 * s.good / std::max(1, s.textured),
            100.0 * s.known / std::max(1, s.textured), s.percentile(0.5), s.percentile(0.9),
            s.percentile(0.99));
        EXPECT_GE(s.good, 0.9 * s.textured);
        textured += s.textured;
        good += s.good;
      }
    }
  }
  EXPECT_GT(textured, 12 * 320 * 240 / 10);
  EXPECT_GE(good, 0.9 * textured);
}

}  // namespace
}  // namespace kaz::sim
