// A passive joint between two free bodies: its frames, its error and its coordinate.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/reduced/passive_joint.h"

#include <cmath>
#include <numbers>

namespace kaz::sim {
namespace {

Eigen::Matrix3d basis_about(const Eigen::Vector3d& axis) {
  Eigen::Matrix3d basis;
  basis.col(2) = axis.normalized();
  basis.col(0) = basis.col(2).unitOrthogonal();
  basis.col(1) = basis.col(2).cross(basis.col(0));
  return basis;
}

JointFrame seen_from(const FreeBody* body, const JointFrame& world) {
  if (body == nullptr) return world;
  const Eigen::Matrix3d to_body = body->axes().transpose();
  return {to_body * (world.at - body->com), to_body * world.basis};
}

}  // namespace

JointFrame frame_on(const FreeBody* body, const JointFrame& frame) {
  if (body == nullptr) return frame;
  return {body->com + body->axes() * frame.at, body->axes() * frame.basis};
}

PassiveJoint::PassiveJoint(const WorldJoint& from, const FreeBody* parent_body,
                           const FreeBody* child_body)
    : kind(from.kind),
      lower(from.lower),
      upper(from.upper),
      damping(from.damping),
      friction(from.friction) {
  const FreeBody* moving = child_body != nullptr ? child_body : parent_body;
  const bool slides = kind == WorldJoint::Kind::prismatic && moving != nullptr;
  const JointFrame world{slides ? moving->com : from.anchor, basis_about(from.axis)};
  in_parent = seen_from(parent_body, world);
  in_child = seen_from(child_body, world);
}

// With R the child's basis in the parent's, z its third column: the tilt is e_z x z. Its rate is the relative
// angular velocity to first order in the tilt.
PassiveJoint::Gap PassiveJoint::gap(const JointFrame& parent, const JointFrame& child) {
  const Eigen::Matrix3d turn = parent.basis.transpose() * child.basis;
  return {parent.basis.transpose() * (child.at - parent.at),
          {-turn(1, 2), turn(0, 2), std::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1))}};
}

double PassiveJoint::coordinate(const Gap& gap, double before) const {
  if (kind == WorldJoint::Kind::prismatic) return gap.shift.z();
  if (kind == WorldJoint::Kind::ball) return 0;
  return before + std::remainder(gap.turn.z() - before, 2 * std::numbers::pi);
}

}  // namespace kaz::sim
