// Finds what touches what, and makes the solver's contact rows of it.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contacts.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace kaz::sim {
namespace {

// A box on a plane has four corners; two boxes rarely need more.
constexpr int kContactsPerPair = 4;
// Parts up to so many joints apart do not collide: a thigh with the foot, a forearm with the trunk.
constexpr int kExemptGenerations = 3;
constexpr double kErp = 0.2;
constexpr double kMotionToAlign = 1e-4;  // m/s

Eigen::Vector3d velocity_of(dBodyID body) {
  return body ? to_eigen(dBodyGetLinearVel(body)) : Eigen::Vector3d::Zero().eval();
}

// Shape of ours as ODE's, without a place yet; null for kinds that do not collide.
dGeomID make_geom(dSpaceID space, const Shape& shape) {
  const Eigen::Vector3d& s = shape.size;
  switch (shape.kind) {
    case Shape::Kind::box:
      return dCreateBox(space, s.x(), s.y(), s.z());
    case Shape::Kind::sphere:
      return dCreateSphere(space, s.x());
    case Shape::Kind::cylinder:
      return dCreateCylinder(space, s.x(), s.y());
    case Shape::Kind::capsule:
      return dCreateCapsule(space, s.x(), s.y());
    case Shape::Kind::plane:
      return dCreatePlane(space, 0, 0, 1, 0);
    case Shape::Kind::mesh:
      break;
  }
  return nullptr;
}

}  // namespace

Contacts::Contacts(dWorldID world, const RobotModel& robot)
    : world_(world),
      robot_space_(dSimpleSpaceCreate(nullptr)),
      fixed_space_(dSimpleSpaceCreate(nullptr)),
      object_space_(dSimpleSpaceCreate(nullptr)),
      rows_(dJointGroupCreate(0)),
      robot_links_(robot.links.size()) {
  exempt_.assign(robot_links_ * robot_links_, 0);
  for (std::size_t link = 0; link < robot_links_; ++link) {
    exempt_[link * robot_links_ + link] = 1;
    int ancestor = static_cast<int>(link);
    for (int up = 0; up < kExemptGenerations; ++up) {
      ancestor = robot.links[static_cast<std::size_t>(ancestor)].parent;
      if (ancestor < 0) break;
      exempt_[link * robot_links_ + static_cast<std::size_t>(ancestor)] = 1;
      exempt_[static_cast<std::size_t>(ancestor) * robot_links_ + link] = 1;
    }
  }
}

void Contacts::add_robot_link(const RigidLink& link, int robot_link, dBodyID body,
                              const Eigen::Isometry3d& pose) {
  add(link, robot_link, body, pose, robot_space_.get());
}

void Contacts::add_object(const RigidLink& link, dBodyID body, const Eigen::Isometry3d& pose) {
  add(link, -1, body, pose, body ? object_space_.get() : fixed_space_.get());
}

void Contacts::add(const RigidLink& link, int robot_link, dBodyID body,
                   const Eigen::Isometry3d& pose, dSpaceID space) {
  for (const CollisionShape& shape : link.collisions) {
    const dGeomID geom = make_geom(space, shape.shape);
    if (geom == nullptr) continue;
    dGeomSetData(geom, reinterpret_cast<void*>(static_cast<std::uintptr_t>(geoms_.size())));
    geoms_.push_back({shape.surface, robot_link});
    const Eigen::Isometry3d at = body ? shape.in_link : pose * shape.in_link;
    if (shape.shape.kind == Shape::Kind::plane) {
      const Eigen::Vector3d normal = at.linear().col(2);
      dGeomPlaneSetParams(geom, normal.x(), normal.y(), normal.z(), normal.dot(at.translation()));
      continue;
    }
    dMatrix3 rotation;
    to_ode(at.linear(), rotation);
    if (body) {
      const Eigen::Vector3d offset = at.translation() - link.com;
      dGeomSetBody(geom, body);
      dGeomSetOffsetPosition(geom, offset.x(), offset.y(), offset.z());
      dGeomSetOffsetRotation(geom, rotation);
    } else {
      dGeomSetPosition(geom, at.translation().x(), at.translation().y(), at.translation().z());
      dGeomSetRotation(geom, rotation);
    }
  }
}

void Contacts::update() {
  dJointGroupEmpty(rows_.get());
  const auto space = [](const OdeSpaceHandle& s) { return reinterpret_cast<dGeomID>(s.get()); };
  dSpaceCollide(robot_space_.get(), this, &near_callback);
  dSpaceCollide2(space(robot_space_), space(fixed_space_), this, &near_callback);
  if (dSpaceGetNumGeoms(object_space_.get()) == 0) return;
  dSpaceCollide(object_space_.get(), this, &near_callback);
  dSpaceCollide2(space(object_space_), space(fixed_space_), this, &near_callback);
  dSpaceCollide2(space(robot_space_), space(object_space_), this, &near_callback);
}

void Contacts::near_callback(void* self, dGeomID a, dGeomID b) {
  static_cast<Contacts*>(self)->touch(a, b);
}

const Contacts::Geom& Contacts::of(dGeomID geom) const {
  return geoms_[reinterpret_cast<std::uintptr_t>(dGeomGetData(geom))];
}

void Contacts::touch(dGeomID a, dGeomID b) {
  const dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
  const bool awake_a = body_a && dBodyIsEnabled(body_a);
  const bool awake_b = body_b && dBodyIsEnabled(body_b);
  if (!awake_a && !awake_b) return;
  const Geom &ga = of(a), &gb = of(b);
  if (ga.robot_link >= 0 && gb.robot_link >= 0 &&
      exempt_[static_cast<std::size_t>(ga.robot_link) * robot_links_ +
              static_cast<std::size_t>(gb.robot_link)]) {
    return;
  }
  std::array<dContactGeom, kContactsPerPair> found;
  const int count = dCollide(a, b, kContactsPerPair, found.data(), sizeof(dContactGeom));
  if (count == 0) return;

  dContact contact{};
  const Surface &sa = ga.surface, &sb = gb.surface;
  contact.surface.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM;
  contact.surface.mu = std::min(sa.mu, sb.mu);
  contact.surface.soft_erp = kErp;
  contact.surface.soft_cfm = std::max(sa.softness + sb.softness, dWorldGetCFM(world_));
  const Surface& livelier = sa.restitution >= sb.restitution ? sa : sb;
  if (livelier.restitution > 0) {
    contact.surface.mode |= dContactBounce;
    contact.surface.bounce = livelier.restitution;
    contact.surface.bounce_vel = livelier.bounce_threshold;
  }
  const double rolling = std::max(sa.rolling_resistance, sb.rolling_resistance);
  if (rolling > 0) {
    contact.surface.mode |= dContactRolling;
    contact.surface.rho = rolling;
    contact.surface.rho2 = rolling;
    contact.surface.rhoN = rolling;
    // ODE bounds each axis of the contact by itself: along the motion, or the path would bend.
    const Eigen::Vector3d motion = velocity_of(body_a) - velocity_of(body_b);
    if (motion.norm() > kMotionToAlign) {
      contact.surface.mode |= dContactFDir1;
      const Eigen::Vector3d normal = to_eigen(found[0].normal);
      Eigen::Vector3d along = motion - normal * normal.dot(motion);
      if (along.norm() < kMotionToAlign) along = normal.unitOrthogonal();
      along.normalize();
      for (int k = 0; k < 3; ++k) contact.fdir1[k] = along[k];
    }
  }
  for (int i = 0; i < count; ++i) {
    contact.geom = found[static_cast<std::size_t>(i)];
    const dJointID row = dJointCreateContact(world_, rows_.get(), &contact);
    dJointAttach(row, body_a, body_b);
  }
}

}  // namespace kaz::sim
