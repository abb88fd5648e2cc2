// What calibration knows of the two eyes: lenses, how they are turned, and the rectified camera.
// SPDX-License-Identifier: Apache-2.0
//
// OpenCV's conventions throughout: pinhole, Brown-Conrady distortion (Brown 1966, in the order
// k1 k2 p1 p2 k3), rectification by a rotation of each camera. Pixel centres at integers.
#pragma once

#include <array>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "vision/image/frame.h"

namespace kaz::vision {

// One camera: from a direction (x/z, y/z) in its frame to a pixel and back.
struct Lens {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 5> distortion{};  // k1 k2 p1 p2 k3

  Eigen::Vector2d distort(const Eigen::Vector2d& direction) const;
  Eigen::Vector2d pixel(const Eigen::Vector2d& direction) const;
  // Inverse of pixel(), by Newton's method to 1e-12. Valid as far out as the distortion grows with
  // the angle, which the lenses of this project do over their whole picture.
  Eigen::Vector2d direction(const Eigen::Vector2d& pixel) const;
};

struct StereoCalibration {
  struct Eye {
    Lens lens;
    Eigen::Matrix3d rectified_from_camera = Eigen::Matrix3d::Identity();  // OpenCV's R1, R2
  };
  int width = 0, height = 0;  // of the pictures, raw and rectified
  Eye left, right;
  CameraModel rectified;  // of both; the baseline along +x of the rectified left frame

  // From the left camera's frame to the right one's, as cv::stereoCalibrate gives them.
  Eigen::Matrix3d right_from_left() const;
  Eigen::Vector3d left_origin_in_right() const;
  // The file that OpenCV's tools write and read (cv::FileStorage, YAML): image_width, image_height,
  // camera_matrix_left, distortion_coefficients_left, R1, P1 and so on for the right eye, R, T, Q.
  std::string yaml() const;
};

}  // namespace kaz::vision
