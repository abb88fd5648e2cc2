// Rectification by a table for each eye.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/rectify.h"

namespace kaz::vision {
Remap rectification(const StereoCalibration& calibration, const StereoCalibration::Eye& eye) {
  const Remap::Size size{calibration.width, calibration.height};
  const CameraModel& to = calibration.rectified;
  return {size, size, [&](int u, int v) -> Remap::Place {
            const Eigen::Vector3d ray = eye.rectified_from_camera.transpose() * to.ray(u, v);
            const Eigen::Vector2d from = eye.lens.pixel(ray.head<2>() / ray.z());
            return {from.x(), from.y(), 1};
          }};
}

namespace {

void apply(const Remap& remap, const Image& raw, Image& rectified) {
  rectified.width = remap.size().width;
  rectified.height = remap.size().height;
  remap.apply(raw.rgb, rectified.rgb);
}

}  // namespace

Rectifier::Rectifier(const StereoCalibration& calibration)
    : left_(rectification(calibration, calibration.left)),
      right_(rectification(calibration, calibration.right)) {}

void Rectifier::rectify(const StereoImages& raw, StereoImages& rectified) const {
  apply(left_, raw.left, rectified.left);
  apply(right_, raw.right, rectified.right);
}

}  // namespace kaz::vision
