// A depth image in squares, and planes as they look in disparity.
// SPDX-License-Identifier: Apache-2.0
//
// With rays (x/z, y/z) = ((u - cx) / fx, (v - cy) / fy) and disparity d = fx B / z, the plane
// n . p = D is, divided by z D / (fx B), d = B/D (nx (u - cx) + ny fx/fy (v - cy) + nz fx).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "vision/depth/depth.h"

namespace kaz::vision {

// d = a (u - cx) + b (v - cy) + c, px.
struct DisparityPlane {
  float a = 0, b = 0, c = 0;

  float at(float u, float v) const { return a * u + b * v + c; }  // from cx, cy
  // B/D n of the camera's frame, 1/m times m.
  Eigen::Vector3d scaled_normal(const CameraModel& camera) const {
    return {a, b * camera.fy / camera.fx, c / camera.fx};
  }
  static DisparityPlane of(const Eigen::Vector3d& scaled_normal, const CameraModel& camera) {
    return {static_cast<float>(scaled_normal.x()),
            static_cast<float>(scaled_normal.y() * camera.fx / camera.fy),
            static_cast<float>(scaled_normal.z() * camera.fx)};
  }
};

struct Cell {
  float u = 0, v = 0;   // mean of its pixels with depth, from cx, cy
  float d = 0;          // their mean disparity
  bool usable = false;  // a quarter of its pixels or more have depth, of about one surface
};

struct CellGrid {
  int size = 1;  // px a side
  int columns = 0, rows = 0;
  float cx = 0, cy = 0;
  std::vector<Cell> cells;

  void fill(const DepthImage& depth);

 private:
  std::vector<float> sum_, min_, max_;  // of the columns of a row of cells
  std::vector<int> count_;
  std::vector<std::array<float, 3>> known_;
  Cell partly(const DepthImage& depth, int column, int row, float spread);
};

// The plane nearest to points by least squares; false where they do not span one.
class PlaneFit {
 public:
  void add(double u, double v, double d) {
    uu_ += u * u;
    uv_ += u * v;
    vv_ += v * v;
    u_ += u;
    v_ += v;
    n_ += 1;
    right_ += d * Eigen::Vector3d(u, v, 1);
  }
  bool solve(DisparityPlane& plane) const;

 private:
  double uu_ = 0, uv_ = 0, vv_ = 0, u_ = 0, v_ = 0, n_ = 0;
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
};

}  // namespace kaz::vision
