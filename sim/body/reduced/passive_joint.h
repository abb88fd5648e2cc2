// A passive joint between two free bodies: its frames, its error and its coordinate.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "sim/body/description/world_model.h"
#include "sim/body/reduced/free_body.h"

namespace kaz::sim {

// Joint frame, as one of the two bodies carries it. The third column of `basis` is the joint's axis.
struct JointFrame {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();
};

struct PassiveJoint {
  WorldJoint::Kind kind = WorldJoint::Kind::revolute;
  int parent = -1, child = -1;  // indices of objects that can move; -1: fixed
  // Joint frame relative to the body's center of mass, in the body's axes. World frame for a fixed body.
  JointFrame in_parent, in_child;
  double lower = 0, upper = 0;  // stops, rad or m
  double damping = 0;           // Nm s/rad or N s/m
  double friction = 0;          // Nm or N

  // The bodies are those of the start; a null pointer means a fixed body.
  PassiveJoint(const WorldJoint& from, const FreeBody* parent_body, const FreeBody* child_body);

  // Motion of the child's joint frame relative to the parent's, in the parent's basis. The three components
  // of `turn` are the tilt of the axis about two directions and the angle about the axis, -pi to pi.
  struct Gap {
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // m
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();   // rad
  };
  static Gap gap(const JointFrame& parent, const JointFrame& child);
  // Returns whether the joint holds the component of `shift` or `turn`.
  bool holds_shift(int k) const { return kind != WorldJoint::Kind::prismatic || k < 2; }
  bool holds_turn(int k) const {
    return kind == WorldJoint::Kind::prismatic || (kind == WorldJoint::Kind::revolute && k < 2);
  }
  // The joint's coordinate, rad or m. `before`: the coordinate a step ago, which selects the turn.
  double coordinate(const Gap& gap, double before) const;
};

// World pose of a joint frame.
JointFrame frame_on(const FreeBody* body, const JointFrame& frame);

}  // namespace kaz::sim
