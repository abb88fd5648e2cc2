// Test scenes of textured rectangles: ray-traced stereo pairs and the true disparity.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "shared/base/random.hpp"
#include "vision/depth/depth.h"
#include "vision/image/pictures_testing.h"

namespace kaz::vision {

// A rectangle: all points corner + s along + t across with 0 <= s <= 1 and 0 <= t <= 1. Units m, optical
// frame.
struct TestPatch {
  Eigen::Vector3d corner, along, across;
  double contrast = 60;  // amplitude of the texture, codes; 0: uniform color
  std::uint64_t seed = 1;

  Eigen::Vector3d normal() const { return along.cross(across).normalized(); }
};

struct TestHit {
  int patch = -1;
  // Distance along the ray, in units of the ray's length.
  double distance = std::numeric_limits<double>::infinity();
};

class TestStereoScene {
 public:
  std::vector<TestPatch> patches;

  // Adds a rectangle with the given center and sides.
  TestPatch& add(const Eigen::Vector3d& middle, const Eigen::Vector3d& along,
                 const Eigen::Vector3d& across, double contrast = 60) {
    patches.push_back(
        {middle - 0.5 * along - 0.5 * across, along, across, contrast, mix64(patches.size() + 77)});
    return patches.back();
  }

  TestHit hit(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    TestHit best;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const TestPatch& p = patches[i];
      const Eigen::Vector3d n = p.along.cross(p.across);
      const double slope = n.dot(ray);
      if (std::abs(slope) < 1e-12) continue;
      const double distance = n.dot(p.corner - from) / slope;
      if (distance <= 1e-6 || distance >= best.distance) continue;
      const Eigen::Vector3d at = from + distance * ray - p.corner;
      const double s = at.dot(p.along) / p.along.squaredNorm();
      const double t = at.dot(p.across) / p.across.squaredNorm();
      if (s < 0 || s > 1 || t < 0 || t > 1) continue;
      best = {static_cast<int>(i), distance};
    }
    return best;
  }

  // Renders gray pictures in RGB format with 2 x 2 rays per pixel. `sigma` is the standard deviation of the
  // noise (codes), `seed` the seed of the noise.
  StereoImages pictures(const CameraModel& camera, double sigma, std::uint64_t seed) const {
    return {picture(camera, 0, sigma, mix64(seed)),
            picture(camera, camera.baseline_m, sigma, mix64(seed + 1))};
  }

  // Returns the true disparity (px) of each pixel of the left picture, or 0 if the ray hits no rectangle.
  // Writes to `patch` the index of the rectangle at each pixel, or -1.
  DepthImage truth(const CameraModel& camera, std::vector<int>& patch) const {
    DepthImage depth{test_info(camera), camera.width, camera.height, {}};
    patch.clear();
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const TestHit h = hit(Eigen::Vector3d::Zero(), camera.ray(u, v));
        patch.push_back(h.patch);
        depth.disparity_px.push_back(
            h.patch < 0 ? 0.0F : static_cast<float>(camera.fx * camera.baseline_m / h.distance));
      }
    }
    return depth;
  }

  // Returns whether the point that the left eye sees at this pixel is also visible to the right eye.
  bool seen_by_both(const CameraModel& camera, int u, int v) const {
    const TestHit h = hit(Eigen::Vector3d::Zero(), camera.ray(u, v));
    if (h.patch < 0) return false;
    const Eigen::Vector3d other(camera.baseline_m, 0, 0);
    const Eigen::Vector3d to = h.distance * camera.ray(u, v) - other;
    return std::abs(hit(other, to).distance - 1) < 1e-6;
  }

 private:
  // Smooth noise with grains of 8 mm and 3 mm, -1 to 1.
  static double texture(std::uint64_t seed, double s, double t) {
    const auto layer = [seed](double x, double y, std::uint64_t key) {
      const double i = std::floor(x), j = std::floor(y);
      const auto at = [&](double a, double b) {
        const auto k = mix64(mix64(seed ^ key) ^
                             static_cast<std::uint64_t>(static_cast<std::int64_t>(a) * 100003 +
                                                        static_cast<std::int64_t>(b)));
        return static_cast<double>(k >> 11) * 0x1p-52 - 1;
      };
      const double fx = x - i, fy = y - j;
      return (1 - fy) * ((1 - fx) * at(i, j) + fx * at(i + 1, j)) +
             fy * ((1 - fx) * at(i, j + 1) + fx * at(i + 1, j + 1));
    };
    return 0.6 * layer(s / 0.008, t / 0.008, 1) + 0.4 * layer(s / 0.003, t / 0.003, 2);
  }

  Image picture(const CameraModel& camera, double eye_x, double sigma, std::uint64_t seed) const {
    Image image{camera.width, camera.height, {}};
    const Eigen::Vector3d eye(eye_x, 0, 0);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        double code = 0;
        for (int i = 0; i < 4; ++i) {
          const Eigen::Vector3d r = camera.ray(u + 0.5 * (i % 2) - 0.25, v + 0.5 * (i / 2) - 0.25);
          const TestHit h = hit(eye, r);
          if (h.patch < 0) {
            code += 110.0 / 4;
            continue;
          }
          const TestPatch& p = patches[static_cast<std::size_t>(h.patch)];
          const Eigen::Vector3d at = eye + h.distance * r - p.corner;
          const double grain = p.contrast == 0 ? 0
                                               : texture(p.seed, at.dot(p.along.normalized()),
                                                         at.dot(p.across.normalized()));
          code += (120 + p.contrast * grain) / 4;
        }
        code += sigma *
                keyed_normal(seed, static_cast<std::uint64_t>(v), static_cast<std::uint64_t>(u));
        const auto byte = static_cast<std::uint8_t>(std::lround(std::clamp(code, 0.0, 255.0)));
        image.rgb.insert(image.rgb.end(), 3, byte);
      }
    }
    return image;
  }
};

// A scene with a floor `height` m below the lens, a wall, and the fronts and tops of two boxes. The lens
// looks `tilt` rad below the horizon.
inline TestStereoScene test_room(double height = 0.3, double tilt = 0.6) {
  const Eigen::Vector3d down(0, std::cos(tilt), std::sin(tilt)),
      ahead(0, -std::sin(tilt), std::cos(tilt)), right = Eigen::Vector3d::UnitX();
  TestStereoScene s;
  s.add(height * down, 6 * right, 6 * ahead);
  s.add(1.3 * ahead, 6 * right, 3 * down);
  s.add((height - 0.04) * down + 0.42 * ahead - 0.10 * right, 0.08 * right, 0.08 * down);
  s.add((height - 0.08) * down + 0.46 * ahead - 0.10 * right, 0.08 * right, 0.08 * ahead);
  s.add((height - 0.06) * down + 0.65 * ahead + 0.20 * right, 0.15 * right, 0.12 * down);
  s.add((height - 0.12) * down + 0.70 * ahead + 0.20 * right, 0.15 * right, 0.10 * ahead);
  return s;
}

// A scene with a floor 0.3 m below the lens, a wall 1 m ahead, and the front and top of a box.
inline TestStereoScene test_corner() {
  const double tilt = 0.5;
  const Eigen::Vector3d down(0, std::cos(tilt), std::sin(tilt)),
      ahead(0, -std::sin(tilt), std::cos(tilt)), right = Eigen::Vector3d::UnitX();
  TestStereoScene s;
  s.add(0.3 * down, 6 * right, 6 * ahead);
  s.add(1.0 * ahead, 6 * right, 3 * down);
  s.add(0.25 * down + 0.45 * ahead, 0.2 * right, 0.1 * down);
  s.add(0.20 * down + 0.55 * ahead, 0.2 * right, 0.2 * ahead);
  return s;
}

}  // namespace kaz::vision
