// Robust cone fit.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/cone.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Dense>

namespace kaz::vision {

namespace {

constexpr double kSmallest = 0.05 * 3.14159265358979323846 / 180;
constexpr double kLargest = 85 * 3.14159265358979323846 / 180;

bool usable(const Cone& cone) {
  return std::isfinite(cone.half_angle) && cone.half_angle > kSmallest &&
         cone.half_angle < kLargest && cone.axis.allFinite();
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The cone through three rays: they end on a plane across its axis.
std::optional<Cone> through(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c) {
  const Eigen::Vector3d across = (b - a).cross(c - a);
  if (!(across.norm() > 0)) return std::nullopt;
  Cone cone;
  cone.axis = across.normalized();
  if (cone.axis.dot(a) < 0) cone.axis = -cone.axis;
  cone.half_angle = std::atan2(cone.axis.cross(a).norm(), cone.axis.dot(a));
  if (!usable(cone)) return std::nullopt;
  return cone;
}

// Least median of squares (Rousseeuw 1984): of several cones through three rays each, the one with the
// smallest median distance, so that up to half of the rays may be outliers. The choice of rays is fixed.
std::optional<Cone> min_median(std::span<const Eigen::Vector3d> rays) {
  constexpr int kTrials = 48;
  constexpr std::size_t kJudges = 64;
  std::uint64_t state = 0;
  const auto pick = [&] {
    state = state * 6364136223846793005U + 1442695040888963407U;  // Knuth's LCG for 64 bits
    return rays[(state >> 33) % rays.size()];
  };
  const std::size_t stride = std::max<std::size_t>(1, rays.size() / kJudges);
  std::optional<Cone> best;
  double best_median = std::numeric_limits<double>::infinity();
  std::vector<double> distance;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::Vector3d a = pick(), b = pick(), c = pick();
    const std::optional<Cone> cone = through(a, b, c);
    if (!cone) continue;
    // To first order the angle from the cone.
    const double cosine = std::cos(cone->half_angle), per_sine = 1 / std::sin(cone->half_angle);
    distance.clear();
    for (std::size_t i = 0; i < rays.size(); i += stride) {
      distance.push_back(std::abs(cone->axis.dot(rays[i]) - cosine) * per_sine);
    }
    // The median is below the best so far if more than half of the distances are: seldom.
    const auto below =
        std::ranges::count_if(distance, [best_median](double d) { return d < best_median; });
    if (static_cast<std::size_t>(below) <= distance.size() / 2) continue;
    best_median = median(distance);
    best = cone;
  }
  return best;
}

Eigen::Matrix<double, 3, 2> tangents(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d aside =
      std::abs(axis.x()) < 0.6 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Eigen::Matrix<double, 3, 2> t;
  t.col(0) = axis.cross(aside).normalized();
  t.col(1) = axis.cross(t.col(0));
  return t;
}

// One weighted Gauss-Newton step; returns its length, or nothing where the rays leave it open.
std::optional<double> improve(Cone& cone, std::span<const Eigen::Vector3d> rays, double noise_rad) {
  std::vector<double> residual(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) residual[i] = angle_outside(cone, rays[i]);
  std::vector<double> size(residual);
  for (double& r : size) r = std::abs(r);
  const double cut = 4.685 * std::max(noise_rad, 1.4826 * median(size));  // Tukey's 95 % efficiency

  const Eigen::Matrix<double, 3, 2> t = tangents(cone.axis);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double weights = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double q = residual[i] / cut;
    if (std::abs(q) >= 1) continue;
    const double weight = (1 - q * q) * (1 - q * q);
    const Eigen::Vector2d across = t.transpose() * rays[i];
    const double sine = across.norm();
    if (!(sine > 0)) continue;
    // residual = acos(axis . ray) - half_angle
    const Eigen::Vector3d gradient(-across.x() / sine, -across.y() / sine, -1);
    normal += weight * gradient * gradient.transpose();
    right -= weight * residual[i] * gradient;
    weights += weight;
  }
  if (weights < 3) return std::nullopt;
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(normal / weights);
  if (lu.rcond() < 1e-7) return std::nullopt;
  const Eigen::Vector3d step = lu.solve(right / weights);
  cone.axis = (cone.axis + t * step.head<2>()).normalized();
  cone.half_angle += step.z();
  return step.norm();
}

}  // namespace

double angle_outside(const Cone& cone, const Eigen::Vector3d& unit_ray) {
  return std::atan2(cone.axis.cross(unit_ray).norm(), cone.axis.dot(unit_ray)) - cone.half_angle;
}

std::optional<Cone> fit_cone(std::span<const Eigen::Vector3d> unit_rays, double noise_rad) {
  constexpr std::size_t kFewest = 5;
  if (unit_rays.size() < kFewest) return std::nullopt;
  std::optional<Cone> cone = min_median(unit_rays);
  if (!cone) return std::nullopt;
  for (int i = 0; i < 12; ++i) {
    const std::optional<double> step = improve(*cone, unit_rays, noise_rad);
    if (!step || !usable(*cone)) return std::nullopt;
    if (*step < 1e-7) break;
  }
  return cone;
}

std::optional<EllipseAxes> ellipse_axes(const Cone& cone) {
  const double sine = std::sin(cone.half_angle), cosine = std::cos(cone.half_angle);
  const double off_axis2 = cone.axis.head<2>().squaredNorm();
  const double a = cosine * cosine - off_axis2;
  if (!(a > 1e-6) || !(cone.axis.z() > 0)) return std::nullopt;
  return EllipseAxes{sine / std::sqrt(a), cosine * sine / a};
}

}  // namespace kaz::vision
