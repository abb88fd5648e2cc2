// Shapes, places and inertias of ours as Bullet's.
// SPDX-License-Identifier: Apache-2.0
#include "tools/benchmark/bullet/bullet_shapes.h"

#include <Eigen/Eigenvalues>

#include "sim/body/contact/contact_surface.h"

namespace kaz::sim::bench {
namespace {

std::unique_ptr<btCollisionShape> make_shape(const Shape& shape) {
  const Eigen::Vector3d& s = shape.size;
  switch (shape.kind) {
    case Shape::Kind::box:
      return std::make_unique<btBoxShape>(to_bullet(Eigen::Vector3d(s / 2)));
    case Shape::Kind::sphere:
      return std::make_unique<btSphereShape>(s.x());
    case Shape::Kind::cylinder:
      return std::make_unique<btCylinderShapeZ>(btVector3(s.x(), s.x(), s.y() / 2));
    case Shape::Kind::capsule:
      return std::make_unique<btCapsuleShapeZ>(s.x(), s.y());
    case Shape::Kind::plane:
      return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0);
    case Shape::Kind::mesh:
      break;
  }
  return nullptr;
}

}  // namespace

btMatrix3x3 to_bullet(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}

Eigen::Matrix3d from_bullet(const btMatrix3x3& m) {
  Eigen::Matrix3d out;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) out(row, column) = m[row][column];
  return out;
}

btTransform to_bullet(const Eigen::Isometry3d& pose) {
  return btTransform(to_bullet(Eigen::Matrix3d(pose.linear())),
                     to_bullet(Eigen::Vector3d(pose.translation())));
}

PrincipalFrame principal_frame(const RigidLink& link) {
  PrincipalFrame frame;
  frame.in_link.translation() = link.com;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(link.inertia);
  Eigen::Matrix3d turn = axes.eigenvectors();
  if (turn.determinant() < 0) turn.col(2) *= -1;
  frame.in_link.linear() = turn;
  frame.moments = axes.eigenvalues();
  return frame;
}

btCollisionShape* BulletShapes::keep(std::unique_ptr<btCollisionShape> shape,
                                     const Surface& surface) {
  surfaces_.push_back(std::make_unique<Surface>(surface));
  shape->setUserPointer(surfaces_.back().get());
  shapes_.push_back(std::move(shape));
  return shapes_.back().get();
}

btCollisionShape* BulletShapes::of_link(const RigidLink& link, const PrincipalFrame& frame) {
  auto whole = std::make_unique<btCompoundShape>();
  for (const CollisionShape& part : link.collisions) {
    auto shape = make_shape(part.shape);
    if (!shape || part.shape.kind == Shape::Kind::plane) continue;
    const Eigen::Isometry3d at = frame.in_link.inverse() * part.in_link;
    whole->addChildShape(to_bullet(at), keep(std::move(shape), part.surface));
  }
  if (whole->getNumChildShapes() == 0) return nullptr;
  return keep(std::move(whole), {});
}

btCollisionShape* BulletShapes::of_fixed(const CollisionShape& part, const Eigen::Isometry3d& link,
                                         btTransform& at) {
  auto shape = make_shape(part.shape);
  if (!shape) return nullptr;
  at = to_bullet(Eigen::Isometry3d(link * part.in_link));
  return keep(std::move(shape), part.surface);
}

bool join_surfaces(btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int,
                   const btCollisionObjectWrapper* b, int, int) {
  const auto* one = static_cast<const Surface*>(a->getCollisionShape()->getUserPointer());
  const auto* other = static_cast<const Surface*>(b->getCollisionShape()->getUserPointer());
  if (!one || !other) return false;
  const Surface pair = joined(*one, *other);
  point.m_combinedFriction = pair.mu;
  point.m_combinedRollingFriction = point.m_combinedSpinningFriction = pair.rolling_resistance;
  point.m_combinedRestitution = pair.restitution;
  point.m_contactPointFlags |= BT_CONTACT_FLAG_HAS_CONTACT_CFM | BT_CONTACT_FLAG_HAS_CONTACT_ERP;
  point.m_contactCFM = pair.softness;  // m/s per N, as ODE's; the solver divides by the step
  point.m_contactERP = kContactErp;
  return true;
}

}  // namespace kaz::sim::bench
