// Calibration of the two eyes: lenses, rotations of the cameras, and the camera model after rectification.
// SPDX-License-Identifier: Apache-2.0
//
// The conventions are the same as in OpenCV: pinhole model, Brown-Conrady distortion, rectification by a
// rotation of each camera. The coefficients of the distortion (Brown 1966) have the order k1 k2 p1 p2 k3.
// The center of a pixel has integer coordinates.
#pragma once

#include <array>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "vision/image/frame.h"

namespace kaz::vision {

// One camera: maps a direction (x/z, y/z) in the camera's frame to a pixel and back. Parameters in px.
struct Lens {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 5> distortion{};  // k1 k2 p1 p2 k3

  Eigen::Vector2d distort(const Eigen::Vector2d& direction) const;
  Eigen::Vector2d pixel(const Eigen::Vector2d& direction) const;
  // Inverse of pixel(), computed by Newton's method with an accuracy of 1e-12. Valid only where the distorted
  // radius increases with the angle from the lens axis. With the lenses of this project, the whole picture is
  // valid.
  Eigen::Vector2d direction(const Eigen::Vector2d& pixel) const;
};

struct StereoCalibration {
  struct Eye {
    Lens lens;
    Eigen::Matrix3d rectified_from_camera = Eigen::Matrix3d::Identity();  // OpenCV's R1, R2
  };
  int width = 0, height = 0;  // size of every picture, raw or rectified
  Eye left, right;
  // Camera model of both eyes; baseline along +x of the rectified left frame.
  CameraModel rectified;

  // Rotation R and translation T (m) from the left camera's frame to the right camera's frame, as
  // cv::stereoCalibrate returns them.
  Eigen::Matrix3d right_from_left() const;
  Eigen::Vector3d left_origin_in_right() const;
  // Returns the calibration as YAML of cv::FileStorage, which OpenCV's tools can read. calibration_file.h
  // lists the keys.
  std::string yaml() const;
};

}  // namespace kaz::vision
