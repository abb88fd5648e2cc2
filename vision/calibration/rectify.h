// Rectifies pictures of real lenses to pictures of two parallel pinhole cameras.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vision/calibration/calibration.h"
#include "vision/calibration/remap.h"

namespace kaz::vision {

// Returns the table that maps the raw picture of one eye to the picture of a pinhole camera.
Remap rectification(const StereoCalibration& calibration, const StereoCalibration::Eye& eye);

// Rectifies stereo pairs with one calibration. Replaces cv::initUndistortRectifyMap and cv::remap.
class Rectifier {
 public:
  explicit Rectifier(const StereoCalibration& calibration);
  // Both raw pictures must have the size of the calibration; the function does not check the size.
  // `rectified` and `raw` must not be the same object.
  void rectify(const StereoImages& raw, StereoImages& rectified) const;

 private:
  Remap left_, right_;
};

}  // namespace kaz::vision
