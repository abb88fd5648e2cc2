// From the pictures of real lenses to those of two parallel pinholes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vision/calibration/calibration.h"
#include "vision/calibration/remap.h"

namespace kaz::vision {

// One eye's table: its picture to that of a pinhole.
Remap rectification(const StereoCalibration& calibration, const StereoCalibration::Eye& eye);

// Made once for a pair of cameras; the work of cv::initUndistortRectifyMap and cv::remap.
class Rectifier {
 public:
  explicit Rectifier(const StereoCalibration& calibration);
  // Both pictures as the calibration's: their size is not looked at. `rectified` must be another.
  void rectify(const StereoImages& raw, StereoImages& rectified) const;

 private:
  Remap left_, right_;
};

}  // namespace kaz::vision
