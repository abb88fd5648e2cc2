// Planes in a disparity image, and the least-squares fit of a plane.
// SPDX-License-Identifier: Apache-2.0
//
// The ray of pixel (u, v) is (x/z, y/z) = ((u - cx) / fx, (v - cy) / fy). A point at depth z has the
// disparity d = fx B / z, where B is the baseline. A plane has the equation n . p = D. If both sides of the
// plane's equation are divided by z D / (fx B), the result is linear in the pixel coordinates:
//
//   d = B/D (nx (u - cx) + ny fx/fy (v - cy) + nz fx)
//
// Units: px. Frame of n and p: optical (x right, y down, z forward), m.
#pragma once

#include <Eigen/Core>

#include "vision/image/frame.h"

namespace kaz::vision {

// The plane d = a u + b v + c, px. For the conversions to and from normals, u and v must be relative to (cx,
// cy).
struct DisparityPlane {
  float a = 0, b = 0, c = 0;

  float at(float u, float v) const { return a * u + b * v + c; }
  // Returns the normal n, multiplied by B / D. Dimensionless, optical frame.
  Eigen::Vector3d scaled_normal(const CameraModel& camera) const {
    return {a, b * camera.fy / camera.fx, c / camera.fx};
  }
  static DisparityPlane of(const Eigen::Vector3d& scaled_normal, const CameraModel& camera) {
    return {static_cast<float>(scaled_normal.x()),
            static_cast<float>(scaled_normal.y() * camera.fx / camera.fy),
            static_cast<float>(scaled_normal.z() * camera.fx)};
  }
};

// Linear least squares: minimizes sum (a u + b v + c - d)^2 over the added points.
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
  // Solves the normal equations below. The elements of the matrix and of the right side are sums over all
  // points. Returns false if the points are (nearly) collinear.
  //   [uu uv u]   [a]   [ud]
  //   [uv vv v] * [b] = [vd]
  //   [u  v  n]   [c]   [d ]
  bool solve(DisparityPlane& plane) const;

 private:
  double uu_ = 0, uv_ = 0, vv_ = 0, u_ = 0, v_ = 0, n_ = 0;
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
};

}  // namespace kaz::vision
