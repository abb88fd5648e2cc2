// Depth from both eyes with lens, noise and rectification, compared with the objects' true positions.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "sim/render/renderer_kind.h"
#include "sim/render/scenes_testing.h"
#include "sim/render/sensor/eye_testing.h"
#include "sim/render/sensor/sensor.h"
#include "vision/calibration/rectify.h"

namespace kaz::sim {
namespace {

// Centroid of what is red, with what lies between red pixels of a row: the highlight, which is white
// and elsewhere for each eye.
std::optional<Eigen::Vector2d> red(const vision::Image& image) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int v = 0; v < image.height; ++v) {
    int first = image.width, last = -1;
    for (int u = 0; u < image.width; ++u) {
      const std::uint8_t* c = &image.rgb[static_cast<std::size_t>(v * image.width + u) * 3];
      if (c[0] < 40 || c[0] < 2 * c[1] || c[0] < 2 * c[2]) continue;
      first = std::min(first, u);
      last = u;
    }
    for (int u = first; u <= last; ++u) sum += Eigen::Vector3d(u, v, 1);
  }
  if (sum.z() < 8) return std::nullopt;
  return Eigen::Vector2d(sum.head<2>() / sum.z());
}

TEST(Stereo, DepthIsRightWithinHalfAPixelOfDisparity) {
  constexpr double kRadius = 0.02;
  TestScene s;
  s.add_ground("wood");
  const int ball = s.add_ball({0, 0, 0}, kRedBall, kRadius);
  const auto renderer = std::move(*maker_of(kDefaultRenderer)());
  ASSERT_TRUE(renderer->set_scene(s.scene));
  for (const int width : {320, 640}) {
    EyeModel model;
    model.width = width;
    model.height = width * 3 / 4;
    const auto calibration = make_calibration(model, 2, kEyeBaseline_m);
    const Sensor left(model, calibration, Sensor::Eye::left, 1),
        right(model, calibration, Sensor::Eye::right, 1);
    const vision::Rectifier rectifier(calibration);
    const Eigen::Isometry3d eye = look_at({0, 0, 0.5}, {1, 0, 0.2});
    const Eigen::Isometry3d other = eye * Eigen::Translation3d(kEyeBaseline_m, 0, 0);
    std::uint64_t exposure = 0;
    int seen = 0;
    for (const double depth : {0.25, 0.35, 0.5, 0.7}) {
      for (const double across : {-0.55, 0.0, 0.6}) {
        for (const double down : {-0.4, 0.05, 0.4}) {
          const Eigen::Vector3d at(across * depth, down * depth, depth);
          s.pose.frames[static_cast<std::size_t>(ball)].translation() = eye * at;
          vision::StereoImages raw, rectified;
          raw.left = take(*renderer, s.pose, left, eye, exposure);
          raw.right = take(*renderer, s.pose, right, other, exposure);
          ++exposure;
          rectifier.rectify(raw, rectified);
          const auto l = red(rectified.left), r = red(rectified.right);
          ASSERT_TRUE(l && r) << at.transpose();
          const vision::CameraModel& c = calibration.rectified;
          // The middle of a sphere's outline lies at f X Z / (Z^2 - r^2), beyond its centre.
          const double apparent = c.fx * c.baseline_m / (l->x() - r->x());
          const double measured = apparent + kRadius * kRadius / apparent;
          const double half_pixel = depth * depth / (c.fx * c.baseline_m) * 0.5;
          EXPECT_NEAR(measured, depth, half_pixel) << width << ": " << at.transpose();
          EXPECT_NEAR(l->y(), r->y(), 0.5);
          ++seen;
        }
      }
    }
    EXPECT_EQ(seen, 36);
  }
}

}  // namespace
}  // namespace kaz::sim
