// Rigid link as described by robot and world files: mass properties, collision shapes, visual shapes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sim/body/description/scene.h"

namespace kaz::sim {

// Contact parameters of a shape. A contact between two shapes has the smaller mu of the two shapes and the
// sum of the two softnesses. The contact also has the larger of the two rolling resistances, and the larger
// of the two restitutions. The bounce threshold is the threshold of the shape with the larger restitution.
struct Surface {
  double mu = 1.0;              // Coulomb friction coefficient
  double softness = 0;          // compliance, m/s per N (ODE's contact CFM)
  double restitution = 0;       // 0..1
  double bounce_threshold = 0;  // m/s; impacts below this speed do not bounce
  // Lever arm of the rolling moment, m. The rolling moment is rolling_resistance * normal force.
  double rolling_resistance = 0;
};

struct CollisionShape {
  Eigen::Isometry3d in_link = Eigen::Isometry3d::Identity();
  Shape shape;
  Surface surface;
  // Two shapes collide only if their masks have a common bit.
  std::uint16_t mask = 0xffff;
};

struct RigidLink {
  std::string name;
  double mass = 0;                                // kg
  Eigen::Vector3d com = Eigen::Vector3d::Zero();  // center of mass in the link's frame, m
  // Inertia about the center of mass, in the link's axes, kg m^2.
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  std::vector<CollisionShape> collisions;
  // Visuals of the link. Visual::in_frame is relative to the link's frame; Visual::frame is not set yet.
  std::vector<Visual> visuals;
};

// Merges `part` into `link`: mass, inertia, collision shapes and visual shapes. `in_link` is the pose of
// `part` in the frame of `link`.
void weld(RigidLink& link, const RigidLink& part, const Eigen::Isometry3d& in_link);

// Returns the axis-aligned bounding box of a shape whose frame has the given pose. The box is in the frame in
// which `pose` is given. The box is empty for planes and meshes.
Eigen::AlignedBox3d extent(const Shape& shape, const Eigen::Isometry3d& pose);

// Returns whether the point `p` (m, in the shape's frame) lies more than `depth_m` inside the shape. Always
// false for planes and meshes.
bool inside(const Shape& shape, const Eigen::Vector3d& p, double depth_m);

// Returns whether a mass and an inertia are physically possible. The mass and the principal moments of
// inertia must be positive. No principal moment may exceed the sum of the other two moments times `excess`,
// which is above 1 because numbers in files are rounded.
bool physical(double mass, const Eigen::Matrix3d& inertia, double excess = 1.01);

}  // namespace kaz::sim
