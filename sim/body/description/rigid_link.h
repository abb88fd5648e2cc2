// Rigid link as described by robot and world files: mass properties, collision shapes, visual shapes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sim/body/description/scene.h"

namespace kaz::sim {

// Contact parameters of a shape. A pair of shapes has the smaller mu, the sum of both softnesses, the larger
// rolling resistance and the larger restitution. The bounce threshold is that of the shape with the larger
// restitution.
struct Surface {
  double mu = 1.0;                // Coulomb friction
  double softness = 0;            // m/s per N, compliance (ODE's contact CFM)
  double restitution = 0;         // 0..1
  double bounce_threshold = 0;    // m/s; slower impacts do not bounce
  double rolling_resistance = 0;  // m; rolling moment = rolling_resistance * normal force
};

struct CollisionShape {
  Eigen::Isometry3d in_link = Eigen::Isometry3d::Identity();
  Shape shape;
  Surface surface;
};

struct RigidLink {
  std::string name;
  double mass = 0;                                    // kg
  Eigen::Vector3d com = Eigen::Vector3d::Zero();      // m, link's frame
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // kg m^2, about com, link's axes
  std::vector<CollisionShape> collisions;
  // `in_frame` is relative to the link's frame; `frame` is not set yet.
  std::vector<Visual> visuals;
};

// Merges `part`, fixed at pose `in_link`, into `link`: mass, inertia, collision and visual shapes.
void weld(RigidLink& link, const RigidLink& part, const Eigen::Isometry3d& in_link);

// Returns the axis-aligned bounding box of the shape in the parent frame of `pose`. The box is empty for
// planes and meshes.
Eigen::AlignedBox3d extent(const Shape& shape, const Eigen::Isometry3d& pose);

// Returns true if mass and principal moments are positive, and no principal moment exceeds the sum of the
// other two by more than 1 %. The 1 % allows for rounded numbers in files.
bool physical(double mass, const Eigen::Matrix3d& inertia);

}  // namespace kaz::sim
