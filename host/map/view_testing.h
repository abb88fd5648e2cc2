// Test scene of rectangles. Computes inputs for the map: a depth image from rays, and the floor as one
// segment.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/map/local_map.h"
#include "vision/depth/stereo_testing.h"

namespace kaz::map {

inline constexpr double kTestHeight_m = 0.27;  // height of the eye

// Returns the pose of an eye above the origin, which looks `pan` to the left and `tilt` down from straight
// ahead.
inline Eigen::Isometry3d test_eye(double pan_rad, double tilt_rad) {
  Eigen::Isometry3d eye = Eigen::Isometry3d::Identity();
  eye.translation().z() = kTestHeight_m;
  Eigen::Matrix3d axes;  // right, down and ahead of an eye that looks along x
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  eye.linear() = Eigen::AngleAxisd(pan_rad, Eigen::Vector3d::UnitZ()) *
                 Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitY()) * axes;
  return eye;
}

struct TestView {
  vision::PlaneSegments planes;
  vision::DepthImage depth;
};

// Boxes on a floor, in the foot frame.
struct TestYard {
  struct Box {
    Eigen::Vector3d middle, size;
  };
  std::vector<Box> boxes;
  double floor_m = 6;  // length of the floor's sides, m

  // Returns the view through `eye`, with noise of `sigma_px` in the disparity.
  TestView seen(const Eigen::Isometry3d& eye, double sigma_px = 0, std::uint64_t number = 1,
                int width = 320) const {
    using Eigen::Vector3d;
    const Eigen::Isometry3d in = eye.inverse();
    vision::TestStereoScene scene;
    const auto add = [&](const Vector3d& middle, const Vector3d& along, const Vector3d& across) {
      scene.add(in * middle, in.linear() * along, in.linear() * across);
    };
    add(Vector3d::Zero(), floor_m * Vector3d::UnitX(), floor_m * Vector3d::UnitY());
    for (const Box& b : boxes) {
      const Vector3d x = b.size.x() * Vector3d::UnitX(), y = b.size.y() * Vector3d::UnitY(),
                     z = b.size.z() * Vector3d::UnitZ();
      for (const double side : {-0.5, 0.5}) {
        add(b.middle + side * x, y, z);
        add(b.middle + side * y, x, z);
        add(b.middle + side * z, x, y);
      }
    }
    TestView view;
    std::vector<int> patch;
    view.depth = scene.truth(vision::test_camera(width, width * 3 / 4), patch);
    vision::FrameInfo& info = view.depth.info;
    info.sequence = number;
    info.exposure = from_seconds(0.1 * static_cast<double>(number));
    info.posture_known = true;
    info.foot_from_eye = eye;
    for (std::size_t k = 0; k < patch.size(); ++k) {
      float& d = view.depth.disparity_px[k];
      if (d > 0) d += static_cast<float>(sigma_px * keyed_normal(77, number, k));
      view.planes.label.push_back(patch[k] == 0 ? 1 : 0);
    }
    view.planes.info = info;
    view.planes.width = view.depth.width;
    view.planes.height = view.depth.height;
    vision::PlaneSegment& floor = view.planes.segments.emplace_back();
    floor.floor = true;
    floor.middle = in * Vector3d(0.5, 0, 0);
    floor.normal = in.linear() * Vector3d::UnitZ();
    floor.distance_m = eye.translation().z();
    for (const std::uint8_t label : view.planes.label) floor.pixels += label;
    return view;
  }
};

}  // namespace kaz::map
