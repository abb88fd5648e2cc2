// Pinhole geometry: focal length from the angle of view, a camera that looks at a point.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/camera.h"

#include <cmath>

namespace kaz::sim {

vision::CameraModel camera_of_view(int width, int height, double horizontal_rad) {
  // f = width / 2 / tan(view / 2), px: the borders are half a pixel beyond the outermost pixel centres.
  const double f = 0.5 * width / std::tan(0.5 * horizontal_rad);
  return {width, height, f, f, 0.5 * (width - 1), 0.5 * (height - 1)};
}

Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.translation() = eye;
  return pose;
}

}  // namespace kaz::sim
