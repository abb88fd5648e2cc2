// Fits a cone to rays by least squares. For example, the rays to the outline of a sphere form a cone.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace kaz::vision {

struct Cone {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // unit vector
  double half_angle = 0;                            // rad
};

// Fits a cone to rays. The initial cone goes through three of the rays. Several initial cones are tried, and
// the cone with the smallest median distance to all rays is used. Then Gauss-Newton minimizes the angles
// between rays and cone, with Tukey's weights. Rays that are too far from the cone get weight 0. The limit is
// about five times the spread of all angles between rays and cone. If `noise_rad` is larger than the spread,
// the limit is about five times `noise_rad`. Returns nullopt if the rays do not determine a cone with a half
// angle of 0.05 to 85 degrees.
std::optional<Cone> fit_cone(std::span<const Eigen::Vector3d> unit_rays, double noise_rad);

// Returns the angle (rad) by which a ray lies outside the cone; negative inside.
double angle_outside(const Cone& cone, const Eigen::Vector3d& unit_ray);

// Half axes of the ellipse that a cone forms in the image of a pinhole camera with focal length 1. The half
// angle of the cone is alpha, and the angle between the axes of cone and camera is theta.
// Let A = cos^2(alpha) - sin^2(theta). Then `across` is sin(alpha) / sqrt(A), and `along` is
// cos(alpha) * sin(alpha) / A.
struct EllipseAxes {
  double across, along;
};

// Returns nullopt if a ray of the cone is 90 degrees or more off the optical axis.
std::optional<EllipseAxes> ellipse_axes(const Cone& cone);

}  // namespace kaz::vision
