// Ray-traced pictures of spheres with anti-aliased outlines, for tests and benchmarks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "vision/image/frame.h"

namespace kaz::vision {

// A camera with a horizontal view of 80 degrees and a baseline of 4 cm.
inline CameraModel test_camera(int width = 320, int height = 240) {
  const double f = 0.5 * width / std::tan(40.0 * 3.14159265358979323846 / 180);
  return {width, height, f, f, 0.5 * (width - 1), 0.5 * (height - 1), 0.040};
}

inline FrameInfo test_info(const CameraModel& camera) {
  FrameInfo info;
  info.camera = camera;
  return info;
}

struct TestColor {
  double r, g, b;  // 0..255
};
inline constexpr TestColor kTestRed{215, 25, 20}, kTestGrey{150, 152, 148};

inline Image plain_picture(int width, int height, const TestColor& color) {
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    for (const double c : {color.r, color.g, color.b}) {
      image.rgb.push_back(static_cast<std::uint8_t>(std::lround(c)));
    }
  }
  return image;
}

// Paints a sphere (center and radius in m, optical frame). Each pixel is divided into 10 x 10 sub-pixels. The
// new color is a mixture of sphere and background, by the share of sub-pixels whose rays hit the sphere.
inline void paint_sphere(Image& image, const CameraModel& camera, const Eigen::Vector3d& center,
                         double radius, const TestColor& color) {
  constexpr int kSub = 10;
  const double cosine = std::sqrt(1 - std::pow(radius / center.norm(), 2));
  const Eigen::Vector3d axis = center.normalized();
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const Eigen::Vector3d middle((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1);
      const double margin = 1.5 / camera.fx;
      const double angle = std::acos(std::min(1.0, middle.normalized().dot(axis)));
      const double off = angle - std::acos(cosine);
      if (off > margin) continue;
      int inside = off < -margin ? kSub * kSub : 0;
      for (int i = 0; off >= -margin && i < kSub * kSub; ++i) {
        const double du = (i % kSub + 0.5) / kSub - 0.5, dv = (i / kSub + 0.5) / kSub - 0.5;
        const Eigen::Vector3d ray(middle.x() + du / camera.fx, middle.y() + dv / camera.fy, 1);
        if (ray.normalized().dot(axis) >= cosine) ++inside;
      }
      const double share = static_cast<double>(inside) / (kSub * kSub);
      std::uint8_t* p = &image.rgb[static_cast<std::size_t>(v * image.width + u) * 3];
      const double target[3] = {color.r, color.g, color.b};
      for (int c = 0; c < 3; ++c) {
        p[c] = static_cast<std::uint8_t>(std::lround(p[c] + share * (target[c] - p[c])));
      }
    }
  }
}

// SplitMix64 (Steele, Lea, Flood 2014): gives the same numbers with every standard library.
class TestRandom {
 public:
  explicit TestRandom(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
  }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

}  // namespace kaz::vision
