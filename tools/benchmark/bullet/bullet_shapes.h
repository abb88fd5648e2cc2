// Shapes, places and inertias of ours as Bullet's.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>
#include <Eigen/Geometry>

#include "sim/body/description/rigid_link.h"

namespace kaz::sim::bench {

inline btVector3 to_bullet(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
inline Eigen::Vector3d from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
btMatrix3x3 to_bullet(const Eigen::Matrix3d& m);
Eigen::Matrix3d from_bullet(const btMatrix3x3& m);
btTransform to_bullet(const Eigen::Isometry3d& pose);

// Bullet takes a body by its centre of mass and principal axes.
struct PrincipalFrame {
  Eigen::Isometry3d in_link = Eigen::Isometry3d::Identity();
  Eigen::Vector3d moments = Eigen::Vector3d::Zero();  // kg m2
};
PrincipalFrame principal_frame(const RigidLink& link);

// Owns shapes and what they are made of; surfaces are known by the shapes' user pointers.
class BulletShapes {
 public:
  // All shapes of a link in its principal frame; null if there are none that collide.
  btCollisionShape* of_link(const RigidLink& link, const PrincipalFrame& frame);
  // One shape of what never moves, with its place in the world; null if it does not collide.
  btCollisionShape* of_fixed(const CollisionShape& shape, const Eigen::Isometry3d& link,
                             btTransform& at);

 private:
  btCollisionShape* keep(std::unique_ptr<btCollisionShape> shape, const Surface& surface);
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<Surface>> surfaces_;
};

// For gContactAddedCallback: what the two surfaces do to each other, by the rule of every stepper
// (contact_surface.h). Bullet's own rules for a pair are products and sums of other kinds.
bool join_surfaces(btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int,
                   const btCollisionObjectWrapper* b, int, int);

}  // namespace kaz::sim::bench
