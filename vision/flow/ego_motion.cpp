// Ego-motion by iteratively reweighted least squares.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/ego_motion.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace kaz::vision {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t kMaxSamples = 1200, kMinSamples = 50;
constexpr int kMaxIterations = 10;
constexpr double kConverged = 2e-5;     // rad and m: well under a hundredth of a pixel
constexpr double kMinSpread_px = 0.15;  // accuracy of the flow
// Tukey's constant: 95 % efficiency on normal errors (P. J. Huber, E. M. Ronchetti, "Robust statistics",
// 2nd ed., Wiley 2009, ch. 7).
constexpr double kTukey = 4.685;
// Median of the Rayleigh distribution (length of a 2-vector of unit normals): sqrt(2 ln 2).
constexpr double kRayleighMedian = 1.177;

}  // namespace

EgoMotion::EgoMotion(const FrameInfo& before, const FrameInfo& after)
    : camera_(before.camera), later_(after.foot_from_eye.inverse() * before.foot_from_eye) {}

bool EgoMotion::residual(const FlowSample& sample, Vector2d& px, Vector2d& epipolar) const {
  // The static flow is a Moebius function of inverse depth along one line, the epipolar line; the ends of
  // the interval give the ends of the segment. px, earlier image.
  Vector2d from, to;
  if (!flow(sample.at.x(), sample.at.y(), sample.min_inverse_depth, from) ||
      !flow(sample.at.x(), sample.at.y(), sample.max_inverse_depth, to))
    return false;
  epipolar = to - from;
  // Orthogonal projection of the measured flow on the line, clamped to the segment.
  const double length2 = epipolar.squaredNorm();
  double along = 0;
  if (length2 > 0) along = (sample.flow - from).dot(epipolar) / length2;
  const double inside = std::clamp(along, 0.0, 1.0);
  px = sample.flow - from - inside * epipolar;
  if (length2 > 0 && inside == along)
    epipolar /= std::sqrt(length2);
  else
    epipolar.setZero();
  return true;
}

EgoMotion::Correction EgoMotion::correct(const FlowSamples& samples, const PostureError& error) {
  Correction all;
  // Every `stride`-th sample; odd, so that all columns of the cells are sampled.
  const std::size_t stride = (samples.size() / kMaxSamples) | 1;
  if (samples.size() < kMinSamples) return all;
  const Eigen::Isometry3d posture = later_;
  Vector6d xi = Vector6d::Zero();  // rotation vector (rad), translation (m); later optical frame
  // Prior: xi ~ N(0, diag(1 / prior)).
  Vector6d prior;
  prior << Vector3d::Constant(std::pow(error.rotation_rad, -2)),
      Vector3d::Constant(std::pow(error.translation_m, -2));
  const FlowSamples some = samples.every(stride);
  FlowResiduals residuals;
  std::vector<double> lengths;
  for (int k = 0;; ++k) {
    // Residuals under the present pose, px, and their robust scale: median length over the median of the
    // Rayleigh distribution.
    find_residuals(some, camera_, later_, residuals);
    lengths.clear();
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (residuals.valid[i] != 0) lengths.push_back(residuals.length[i]);
    }
    if (lengths.size() < kMinSamples) break;
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    all.spread_px = std::max(*middle / kRayleighMedian, kMinSpread_px);
    if (k == kMaxIterations) break;
    // Normal equations h dxi = b with h = sum w J^T J, b = sum w J^T r; weights w = (1 - |r|^2 / c^2)^2 of
    // Tukey's biweight, c = kTukey times the scale. J: Jacobian of the image point (px) by a small motion of
    // the camera frame, the interaction matrix of a point at normalised coordinates (x, y) and inverse depth
    // w (F. Chaumette, S. Hutchinson, "Visual servo control I", IEEE Robotics & Automation Magazine 13(4),
    // 2006), here for the point's motion, with columns rotation x, y, z, translation x, y, z:
    //   fx (-x y, 1 + x x, -y, w, 0, -x w)
    //   fy (-1 - y y, x y, x, 0, w, -y w)
    // Inside the interval of depth, the epipolar component is explained by depth and projected out: one
    // equation, along the normal of the epipolar line, instead of two.
    auto [h, b] = normal_equations(some, residuals, camera_, std::pow(kTukey * all.spread_px, 2));
    // Information: divided by the variance; a patch of the flow covers a dozen cells with a common error,
    // so 12 / stride samples count as one.
    const double counts = std::min(static_cast<double>(stride) / 12, 1.0);
    h *= counts / (all.spread_px * all.spread_px);
    b *= counts / (all.spread_px * all.spread_px);
    h.diagonal() += prior;
    b -= prior.cwiseProduct(xi);
    const Vector6d step = h.ldlt().solve(b);
    xi += step;
    // Corrected pose: exp(xi) applied after the pose from the postures.
    const Vector3d rotation = xi.head<3>();
    const double angle = rotation.norm();
    Eigen::Isometry3d correction = Eigen::Isometry3d::Identity();
    if (angle > 0)
      correction.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
    correction.translation() = xi.tail<3>();
    later_ = correction * posture;
    // Converged: one more round for the scale only.
    if (step.head<3>().norm() < kConverged && step.tail<3>().norm() < kConverged)
      k = kMaxIterations - 1;
  }
  all.rotation_rad = xi.head<3>();
  all.translation_m = xi.tail<3>();
  return all;
}

}  // namespace kaz::vision
