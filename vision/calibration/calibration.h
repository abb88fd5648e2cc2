// Calibration of the two eyes: lenses, rotations of the cameras, and the rectified camera.
// SPDX-License-Identifier: Apache-2.0
//
// OpenCV's conventions throughout: pinhole, Brown-Conrady distortion (Brown 1966, in the order k1 k2 p1 p2
// k3), rectification by a rotation of each camera. Pixel centers at integers.
#pragma once

#include <array>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "vision/image/frame.h"

namespace kaz::vision {

// One camera: maps a direction (x/z, y/z) in its frame to a pixel and back. Parameters in px.
struct Lens {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 5> distortion{};  // k1 k2 p1 p2 k3

  Eigen::Vector2d distort(const Eigen::Vector2d& direction) const;
  Eigen::Vector2d pixel(const Eigen::Vector2d& direction) const;
  // Inverse of pixel(), by Newton's method to 1e-12. Valid where distortion is monotonic in the angle. The
  // lenses of this project satisfy this over their whole picture.
  Eigen::Vector2d direction(const Eigen::Vector2d& pixel) const;
};

struct StereoCalibration {
  struct Eye {
    Lens lens;
    Eigen::Matrix3d rectified_from_camera = Eigen::Matrix3d::Identity();  // OpenCV's R1, R2
  };
  int width = 0, height = 0;  // picture size, raw and rectified
  Eye left, right;
  CameraModel rectified;  // both eyes; baseline along +x of the rectified left frame

  // Transform from the left camera's frame to the right one's (m), as cv::stereoCalibrate returns it.
  Eigen::Matrix3d right_from_left() const;
  Eigen::Vector3d left_origin_in_right() const;
  // Returns the calibration in the YAML form of cv::FileStorage, which OpenCV's tools read
  // (calibration_file.h lists the keys).
  std::string yaml() const;
};

}  // namespace kaz::vision
