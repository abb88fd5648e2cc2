// For tests: small robots and objects, built without files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/body/description/motor_file.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/world_model.h"

namespace kaz::sim::test {

// Mass (kg) of a rod, length between the joints (m), and inertia (kg m^2) about an axis across the rod and
// about the rod's axis. The center of mass is in the middle of the rod.
constexpr double kRodMass = 0.1, kRodLength = 0.2, kRodInertia = 4e-4, kRodSlim = 2e-5;
constexpr double kFreeRotor = 5e-4;  // rotor inertia of Kaz's motor at the joint, kg m^2

// Returns a motor without friction, backlash and heat. If the bridge is open, only the rotor's inertia acts
// on the joint.
inline MotorParams free_motor() {
  MotorParams motor;
  motor.name = "free";
  motor.stall_slope_nm_per_v = 0.2288;
  motor.back_emf_nms_per_rad = 0.1764;
  motor.rotor_inertia_kgm2 = kFreeRotor;
  motor.max_supply_v = 12;
  return motor;
}

// Appends a link to the chain. `at` is the link's origin in the root's frame at the zero posture. Every link
// except the first gets a joint with the given axis and limits (rad).
inline void add_link(RobotModel& robot, const RigidLink& rigid, const Eigen::Vector3d& at,
                     const Eigen::Vector3d& axis, double lower, double upper) {
  RobotLink link;
  link.rigid = rigid;
  link.at_zero.translation() = at;
  link.parent = static_cast<int>(robot.links.size()) - 1;
  if (link.parent >= 0) {
    link.joint = static_cast<int>(robot.joints.size());
    robot.joints.push_back(
        {std::string("j").append(std::to_string(link.joint)), link.parent + 1, axis, lower, upper});
  }
  robot.frames[rigid.name] = {link.parent + 1, Eigen::Isometry3d::Identity()};
  robot.links.push_back(link);
}

// Returns a robot that consists only of a fixed base.
inline RobotModel fixed_place() {
  RobotModel robot;
  robot.name = "place";
  robot.fixed_base = true;
  RigidLink world;
  world.name = "world";
  add_link(robot, world, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), 0, 0);
  return robot;
}

inline RigidLink rod(const std::string& name) {
  RigidLink link;
  link.name = name;
  link.mass = kRodMass;
  link.com.z() = -kRodLength / 2;
  link.inertia = Eigen::Vector3d(kRodInertia, kRodInertia, kRodSlim).asDiagonal();
  return link;
}

// Returns a chain of `count` rods, named rod0, rod1 and so on. In the zero posture, the chain hangs from a
// fixed base. The joints turn about y. If `crossed` is true, the joints of rod0, rod2 and so on turn about x
// instead.
inline RobotModel chain(int count, bool crossed) {
  RobotModel robot = fixed_place();
  for (int i = 0; i < count; ++i) {
    const bool about_x = crossed && i % 2 == 0;
    add_link(robot, rod(std::string("rod").append(std::to_string(i))), {0, 0, -kRodLength * i},
             about_x ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY(), -1e3, 1e3);
  }
  return robot;
}

inline CollisionShape touching(Shape::Kind kind, const Eigen::Vector3d& size,
                               const Surface& surface) {
  CollisionShape shape;
  shape.shape.kind = kind;
  shape.shape.size = size;
  shape.surface = surface;
  return shape;
}

inline RigidLink box(const std::string& name, double mass, const Eigen::Vector3d& size,
                     const Surface& surface) {
  RigidLink link;
  link.name = name;
  link.mass = mass;
  const Eigen::Vector3d square = size.cwiseProduct(size);
  link.inertia = (mass / 12 * (Eigen::Vector3d::Constant(square.sum()) - square)).asDiagonal();
  link.collisions.push_back(touching(Shape::Kind::box, size, surface));
  return link;
}

inline RigidLink ball(const std::string& name, double mass, double radius, const Surface& surface) {
  RigidLink link;
  link.name = name;
  link.mass = mass;
  link.inertia = 0.4 * mass * radius * radius * Eigen::Matrix3d::Identity();
  link.collisions.push_back(touching(Shape::Kind::sphere, {radius, 0, 0}, surface));
  return link;
}

// Returns a robot with one free link. Unlike an object of the world, this link never sleeps.
inline RobotModel lone(const RigidLink& link) {
  RobotModel robot;
  robot.name = link.name;
  add_link(robot, link, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), 0, 0);
  return robot;
}

// Returns a world with only a floor at z = 0.
inline WorldModel floor_of(const Surface& surface, const Eigen::Vector3d& gravity) {
  WorldModel world;
  world.gravity = gravity;
  WorldBody floor;
  floor.model = floor.rigid.name = "floor";
  floor.fixed = true;
  floor.rigid.collisions.push_back(touching(Shape::Kind::plane, {9, 9, 0}, surface));
  world.bodies.push_back(floor);
  return world;
}

inline WorldBody thing(const RigidLink& rigid, const Eigen::Vector3d& at) {
  WorldBody body;
  body.model = rigid.name;
  body.rigid = rigid;
  body.pose.translation() = at;
  return body;
}

}  // namespace kaz::sim::test
