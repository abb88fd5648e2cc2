// Residuals of flow samples for a given ego-motion, and normal equations of the fit. Plain and AVX2 code give
// equal results. Internal to vision/flow. Formulas and sources are in ego_motion.h and ego_motion.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "vision/image/frame.h"

namespace kaz::vision {

// Flow samples: pixel (u, v) of the earlier image (px), measured flow (px), and bounds of the inverse depth
// (1/m).
struct FlowSamples {
  std::vector<double> u, v, flow_u, flow_v, min_inverse_depth, max_inverse_depth;

  std::size_t size() const { return u.size(); }
  void resize(std::size_t count);
  void set(std::size_t i, double at_u, double at_v, double to_u, double to_v, double min_w,
           double max_w) {
    u[i] = at_u;
    v[i] = at_v;
    flow_u[i] = to_u;
    flow_v[i] = to_v;
    min_inverse_depth[i] = min_w;
    max_inverse_depth[i] = max_w;
  }
  FlowSamples every(std::size_t stride) const;
};

// Results of EgoMotion::residual() for each sample, px. `valid` is 0 where residual() returned false, else 1.
// `free` is 0 where `epipolar` of residual() is zero, else 1.
struct FlowResiduals {
  std::vector<double> u, v, length, epipolar_u, epipolar_v, valid, free;
};
void find_residuals(const FlowSamples& samples, const CameraModel& camera,
                    const Eigen::Isometry3d& later, FlowResiduals& residuals, bool vectors = true);

// Normal equations, summed over the samples: H = sum w J^T J (lower triangle) and b = sum w J^T residual. J
// is the Jacobian of the flow with respect to rotation and translation of the later camera. With r =
// |residual|^2 / cutoff2, the weight w is (1 - r)^2 if r < 1, else 0. The terms are added in the order of the
// samples.
struct NormalEquations {
  Eigen::Matrix<double, 6, 6> h;
  Eigen::Matrix<double, 6, 1> b;
};
NormalEquations normal_equations(const FlowSamples& samples, const FlowResiduals& residuals,
                                 const CameraModel& camera, double cutoff2, bool vectors = true);

}  // namespace kaz::vision
