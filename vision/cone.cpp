// Robust cone fit.
// SPDX-License-Identifier: Apache-2.0
#include "vision/cone.h"

#include <algorithm>
#include <cmath>
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

std::optional<Cone> linear_fit(std::span<const Eigen::Vector3d> rays) {
  // Relative to the mean ray, for a narrow cone is nearly a plane through it.
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& r : rays) mean += r;
  mean /= static_cast<double>(rays.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& r : rays) scatter += (r - mean) * (r - mean).transpose();
  // The rays of a cone end on a plane: its normal is the direction of least scatter.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);
  Cone cone;
  cone.axis = eigen.eigenvectors().col(0);
  if (cone.axis.dot(mean) < 0) cone.axis = -cone.axis;
  cone.half_angle = std::acos(std::clamp(cone.axis.dot(mean), -1.0, 1.0));
  if (!usable(cone)) return std::nullopt;
  return cone;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Eigen::Matrix<double, 3, 2> tangents(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d helper =
      std::abs(axis.x()) < 0.6 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Eigen::Matrix<double, 3, 2> t;
  t.col(0) = axis.cross(helper).normalized();
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
  std::optional<Cone> cone = linear_fit(unit_rays);
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
