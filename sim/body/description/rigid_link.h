// A rigid part as the files describe it: mass properties, collision shapes, visual shapes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sim/body/description/scene.h"

namespace kaz::sim {

// Contact parameters of a shape. A pair has the smaller mu, the sum of the softnesses, the larger restitution
// with its threshold, and the larger rolling resistance.
struct Surface {
  double mu = 1.0;                // Coulomb friction
  double softness = 0;            // m/s per N: ODE's soft contact CFM
  double restitution = 0;         // 0..1
  double bounce_threshold = 0;    // m/s; slower impacts do not bounce
  double rolling_resistance = 0;  // m: rolling moment = this * normal force
};

struct CollisionShape {
  Eigen::Isometry3d in_link = Eigen::Isometry3d::Identity();
  Shape shape;
  Surface surface;
};

struct RigidLink {
  std::string name;
  double mass = 0;
  Eigen::Vector3d com = Eigen::Vector3d::Zero();      // in the link's frame
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about com, axes of the link's frame
  std::vector<CollisionShape> collisions;
  std::vector<Visual> visuals;  // in_frame: in the link's frame; frame is not set yet
};

// Adds a part fixed to `link` at `in_link`: mass, inertia, collision and visual shapes.
void weld(RigidLink& link, const RigidLink& part, const Eigen::Isometry3d& in_link);

// Axis-aligned bounding box of the shape, in the frame that `pose` maps to. Planes have none.
Eigen::AlignedBox3d extent(const Shape& shape, const Eigen::Isometry3d& pose);

// Whether mass and inertia are physically valid: mass and principal moments positive, and no principal moment
// above the sum of the other two.
bool physical(double mass, const Eigen::Matrix3d& inertia);

}  // namespace kaz::sim
