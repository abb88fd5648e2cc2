// Brown-Conrady distortion and its inverse, and the calibration file.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/calibration.h"

#include <cstdio>

#include <Eigen/LU>

namespace kaz::vision {
namespace {

void put(std::string& text, const char* name, int value) {
  text += std::string(name) + ": " + std::to_string(value) + "\n";
}

void put(std::string& text, const char* name, const Eigen::MatrixXd& matrix) {
  text += std::string(name) + ": !!opencv-matrix\n   rows: " + std::to_string(matrix.rows()) +
          "\n   cols: " + std::to_string(matrix.cols()) + "\n   dt: d\n   data: [";
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      char number[40];
      std::snprintf(number, sizeof number, "%.16e", matrix(i, j));
      text += (i + j == 0 ? " " : ",\n       ") + std::string(number);
    }
  }
  text += " ]\n";
}

Eigen::Matrix3d matrix_of(const Lens& lens) {
  Eigen::Matrix3d k;
  k << lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1;
  return k;
}

Eigen::MatrixXd row_of(const Lens& lens) {
  return Eigen::Map<const Eigen::Matrix<double, 1, 5>>(lens.distortion.data());
}

}  // namespace

Eigen::Vector2d Lens::distort(const Eigen::Vector2d& d) const {
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const double x = d.x(), y = d.y(), r2 = d.squaredNorm();
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Eigen::Vector2d Lens::pixel(const Eigen::Vector2d& direction) const {
  const Eigen::Vector2d d = distort(direction);
  return {fx * d.x() + cx, fy * d.y() + cy};
}

Eigen::Vector2d Lens::direction(const Eigen::Vector2d& pixel) const {
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const Eigen::Vector2d wanted((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  Eigen::Vector2d d = wanted;
  for (int round = 0; round < 30; ++round) {
    const Eigen::Vector2d miss = distort(d) - wanted;
    if (miss.squaredNorm() < 1e-24) break;
    const double x = d.x(), y = d.y(), r2 = d.squaredNorm();
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double slope = 2 * (k1 + r2 * (2 * k2 + 3 * r2 * k3));
    Eigen::Matrix2d j;
    j << radial + slope * x * x + 2 * p1 * y + 6 * p2 * x, slope * x * y + 2 * p1 * x + 2 * p2 * y,
        slope * x * y + 2 * p1 * x + 2 * p2 * y, radial + slope * y * y + 6 * p1 * y + 2 * p2 * x;
    d -= j.inverse() * miss;
  }
  return d;
}

// x_rectified = R1 x_left, and the right eye's origin lies at +baseline there.
Eigen::Matrix3d StereoCalibration::right_from_left() const {
  return right.rectified_from_camera.transpose() * left.rectified_from_camera;
}

Eigen::Vector3d StereoCalibration::left_origin_in_right() const {
  return right.rectified_from_camera.transpose() * Eigen::Vector3d(-rectified.baseline_m, 0, 0);
}

std::string StereoCalibration::yaml() const {
  const CameraModel& c = rectified;
  Eigen::Matrix<double, 3, 4> p1 = Eigen::Matrix<double, 3, 4>::Zero();
  p1 << c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0;
  Eigen::Matrix<double, 3, 4> p2 = p1;
  p2(0, 3) = -c.fx * c.baseline_m;
  // (u, v, disparity, 1) to homogeneous coordinates of the rectified left frame.
  Eigen::Matrix4d q = Eigen::Matrix4d::Zero();
  q << 1, 0, 0, -c.cx, 0, c.fx / c.fy, 0, -c.cy * c.fx / c.fy, 0, 0, 0, c.fx, 0, 0,
      1 / c.baseline_m, 0;
  std::string text = "%YAML:1.0\n---\n";
  put(text, "image_width", width);
  put(text, "image_height", height);
  put(text, "camera_matrix_left", matrix_of(left.lens));
  put(text, "distortion_coefficients_left", row_of(left.lens));
  put(text, "camera_matrix_right", matrix_of(right.lens));
  put(text, "distortion_coefficients_right", row_of(right.lens));
  put(text, "R", right_from_left());
  put(text, "T", left_origin_in_right());
  put(text, "R1", left.rectified_from_camera);
  put(text, "R2", right.rectified_from_camera);
  put(text, "P1", p1);
  put(text, "P2", p2);
  put(text, "Q", q);
  return text;
}

}  // namespace kaz::vision
