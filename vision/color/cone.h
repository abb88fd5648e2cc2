// Least-squares cone of rays: what the outline of a sphere is, in perspective.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace kaz::vision {

struct Cone {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // unit
  double half_angle = 0;                            // rad
};

// Start: least median of the distances over cones through three rays each. Then Gauss-Newton on the
// angles between rays and cone, with Tukey's weights: rays off by more than about five times the
// spread (at least `noise_rad`) do not count. Nothing where the rays determine no cone of 0.05 to
// 85 degrees.
std::optional<Cone> fit_cone(std::span<const Eigen::Vector3d> unit_rays, double noise_rad);

// rad, how far a ray lies outside the cone; negative inside.
double angle_outside(const Cone& cone, const Eigen::Vector3d& unit_ray);

// Half axes of the ellipse in which a pinhole camera of focal length 1 sees the cone: across =
// sin(a) / sqrt(A), along = cos(a) sin(a) / A, A = cos^2(a) - sin^2(t), a the half angle, t the
// angle between the cone's axis and the optical axis. Nothing where the cone reaches 90 degrees off
// axis.
struct EllipseAxes {
  double across, along;
};
std::optional<EllipseAxes> ellipse_axes(const Cone& cone);

}  // namespace kaz::vision
