// Solves the normal equations of a plane in a disparity image.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/disparity_plane.h"

#include <Eigen/Cholesky>

namespace kaz::vision {

bool PlaneFit::solve(DisparityPlane& plane) const {
  Eigen::Matrix3d matrix;
  matrix << uu_, uv_, u_, uv_, vv_, v_, u_, v_, n_;
  const Eigen::LDLT<Eigen::Matrix3d> solver(matrix);
  // Pivots are sums of squares of pixels: a row of cells alone leaves one near 0.
  if (solver.info() != Eigen::Success || solver.vectorD().minCoeff() < 1) return false;
  const Eigen::Vector3d x = solver.solve(right_);
  if (!x.allFinite()) return false;
  plane = {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])};
  return true;
}

}  // namespace kaz::vision
