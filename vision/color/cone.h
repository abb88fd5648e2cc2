// Least-squares cone of rays: the outline of a sphere in perspective.
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

// Fits a cone to rays. It starts with the least median of distances among cones through three rays each. Then
// Gauss-Newton minimizes the angles between rays and cone, with Tukey's weights. Rays off by more than about
// five times the spread (at least `noise_rad`) do not count. Returns nullopt if the rays do not determine a
// cone of 0.05 to 85 degrees.
std::optional<Cone> fit_cone(std::span<const Eigen::Vector3d> unit_rays, double noise_rad);

// Returns the angle (rad) by which a ray lies outside the cone; negative inside.
double angle_outside(const Cone& cone, const Eigen::Vector3d& unit_ray);

// Half axes of the ellipse in which a pinhole camera of focal length 1 sees the cone: across = sin(a) /
// sqrt(A), along = cos(a) sin(a) / A. A = cos^2(a) - sin^2(t), where a is the half angle and t the angle
// between the axes of cone and camera.
struct EllipseAxes {
  double across, along;
};

// Returns nullopt if the cone reaches 90 degrees off the optical axis.
std::optional<EllipseAxes> ellipse_axes(const Cone& cone);

}  // namespace kaz::vision
