// Robust least squares on the eye's turn and way.
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
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kMostSights = 1200, kLeastSights = 50;
constexpr int kSteps = 10;
constexpr double kEnd_rad = 2e-5;     // well under a hundredth of a pixel
constexpr double kFinest_px = 0.15;   // flow is no better
constexpr double kTukey = 4.685;      // 95 % as good as least squares on normal errors
constexpr double kMedianOf2 = 1.177;  // of a length in two directions, in standard deviations

}  // namespace

bool EgoMotion::residual(const FlowSample& sight, Vector2d& px, Vector2d& way) const {
  Vector2d from, to;
  if (!flow(sight.at.x(), sight.at.y(), sight.least, from) ||
      !flow(sight.at.x(), sight.at.y(), sight.most, to))
    return false;
  way = to - from;
  const double length2 = way.squaredNorm();
  double along = 0;
  if (length2 > 0) along = (sight.flow - from).dot(way) / length2;
  const double inside = std::clamp(along, 0.0, 1.0);
  px = sight.flow - from - inside * way;
  if (length2 > 0 && inside == along)
    way /= std::sqrt(length2);
  else
    way.setZero();
  return true;
}

EgoMotion::Correction EgoMotion::correct(std::span<const FlowSample> sights,
                                         const PostureError& error) {
  Correction all;
  // An odd step, so that no column of the cells is left out.
  const std::size_t step = (sights.size() / kMostSights) | 1;
  if (sights.size() < kLeastSights) return all;
  const Eigen::Isometry3d posture = later_;
  Vector6d total = Vector6d::Zero();
  Vector6d prior;
  prior << Vector3d::Constant(std::pow(error.turn_rad, -2)),
      Vector3d::Constant(std::pow(error.shift_m, -2));
  struct Left {
    Vector2d px, way;
    std::size_t sight;
  };
  std::vector<Left> left;
  std::vector<double> lengths;
  for (int k = 0;; ++k) {
    left.clear();
    lengths.clear();
    for (std::size_t i = 0; i < sights.size(); i += step) {
      Left one{{}, {}, i};
      if (!residual(sights[i], one.px, one.way)) continue;
      left.push_back(one);
      lengths.push_back(one.px.norm());
    }
    if (lengths.size() < kLeastSights) break;
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    all.spread_px = std::max(*middle / kMedianOf2, kFinest_px);
    if (k == kSteps) break;
    const double reach2 = std::pow(kTukey * all.spread_px, 2);
    Matrix6d h = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    for (const Left& one : left) {
      const double off = one.px.squaredNorm() / reach2;
      if (off >= 1) continue;
      const FlowSample& s = sights[one.sight];
      const Vector2d to = s.at + s.flow - one.px;
      const double x = (to.x() - camera_.cx) / camera_.fx, y = (to.y() - camera_.cy) / camera_.fy;
      const double w = (s.least + s.most) / 2;
      Eigen::Matrix<double, 2, 6> j;
      j << -x * y, 1 + x * x, -y, w, 0, -x * w,  //
          -1 - y * y, x * y, x, 0, w, -y * w;
      j.row(0) *= camera_.fx;
      j.row(1) *= camera_.fy;
      // Depth takes up what leads along the way.
      if (!one.way.isZero()) {
        const Vector2d across(-one.way.y(), one.way.x());
        const Vector6d g = j.transpose() * across;
        h.noalias() += (1 - off) * (1 - off) * g * g.transpose();
        b.noalias() += (1 - off) * (1 - off) * across.dot(one.px) * g;
      } else {
        h.noalias() += (1 - off) * (1 - off) * j.transpose() * j;
        b.noalias() += (1 - off) * (1 - off) * j.transpose() * one.px;
      }
    }
    // A patch of the flow covers a dozen cells, which err together.
    const double counts = std::min(static_cast<double>(step) / 12, 1.0);
    h *= counts / (all.spread_px * all.spread_px);
    b *= counts / (all.spread_px * all.spread_px);
    h.diagonal() += prior;
    b -= prior.cwiseProduct(total);
    const Vector6d by = h.ldlt().solve(b);
    total += by;
    const Vector3d turn = total.head<3>();
    const double angle = turn.norm();
    Eigen::Isometry3d more = Eigen::Isometry3d::Identity();
    if (angle > 0) more.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    more.translation() = total.tail<3>();
    later_ = more * posture;
    if (by.head<3>().norm() < kEnd_rad && by.tail<3>().norm() < kEnd_rad) k = kSteps - 1;
  }
  all.turn_rad = total.head<3>();
  all.shift_m = total.tail<3>();
  return all;
}

}  // namespace kaz::vision
