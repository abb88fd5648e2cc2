// Robot model, loaded from a URDF or MJCF, in the form that the dynamics use.
// SPDX-License-Identifier: Apache-2.0
//
// docs/reference/robot.md specifies which files are accepted. Links at fixed joints are merged into
// their parent link; RobotModel::frames still lists their frames.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "sim/body/description/joint_names.h"
#include "sim/body/description/reading.h"
#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

struct RobotLink {
  RigidLink rigid;
  int parent = -1;  // index into RobotModel::links, always smaller than this link's index
  // Index into RobotModel::joints of the joint that moves this link. -1: this link is the root.
  int joint = -1;
  // Pose of this link in the root link's frame, at the zero posture.
  Eigen::Isometry3d at_zero = Eigen::Isometry3d::Identity();
};

// A joint without a motor that follows another joint: angle = ratio * (angle of `joint`) + offset.
struct JointCoupling {
  int joint = 0;  // index into RobotModel::joints of a joint with a motor
  double ratio = 1;
  double offset = 0;  // rad
};

struct RobotJoint {
  std::string name;
  int child = 0;  // index into RobotModel::links
  // Unit vector in the root link's frame, at the zero posture.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  // Software limits of the angle, rad; infinite for a joint without limits. The mechanical stops are beyond
  // these limits (stop_margin.h).
  double lower = 0, upper = 0;
  // Limits of speed (rad/s) and torque (Nm); infinite if the file states none.
  double velocity = std::numeric_limits<double>::infinity();
  double effort = std::numeric_limits<double>::infinity();
  double damping = 0;   // viscous friction, Nm s/rad
  double friction = 0;  // Coulomb friction, Nm
  std::optional<JointCoupling> follows = std::nullopt;
  // 0: the joint turns. Otherwise, the joint is prismatic: a pinion of this radius (m) drives a rack along
  // `axis`. Angle, limits and losses of the joint are those of the pinion.
  double pinion_m = 0;
};

// Radius of the pinion that a prismatic joint gets, m: its range is a quarter turn, as of a usual gripper.
// 10 mm without a range.
double pinion_radius(double lower_m, double upper_m);
// Converts the values of a prismatic joint from m and N to the pinion's rad and Nm.
void convert_to_pinion(RobotJoint& joint);
// Lets a joint follow another one. `coupling` is in the units of the file: m for prismatic joints.
void set_coupling(std::vector<RobotJoint>& joints, int follower, const JointCoupling& coupling);
// Motion of the child link at this angle, in the link's axes. `axis`: unit vector in the same axes.
Eigen::Isometry3d joint_motion(const RobotJoint& joint, const Eigen::Vector3d& axis, double angle);

// Frame of a link of the file, fixed to a link of the model.
struct RobotFrame {
  int link = 0;  // index into RobotModel::links
  Eigen::Isometry3d in_link = Eigen::Isometry3d::Identity();
};

struct RobotModel {
  std::string name;
  std::vector<RobotLink> links;  // parents before children; the root is first
  // True if the root link is named `world`. A root link with this name never moves.
  bool fixed_base = false;
  // Joints with one degree of freedom. Kaz's joints are in the order of shared/board/joints.def. The joints
  // of another robot are in the order of its file. Joints that follow another joint come after all joints
  // with a motor.
  std::vector<RobotJoint> joints;
  std::map<std::string, RobotFrame> frames;  // by link name, including merged links

  std::vector<FileNote> notes;  // elements of the file that are not used

  bool is_kaz() const;         // the joints with a motor are those of joints.def
  double mass() const;         // kg
  std::size_t motors() const;  // number of joints that do not follow another joint
  std::vector<std::string> joint_order() const;  // names of the joints with a motor
  // Index of the link to which the frames `left_eye` and `right_eye` are fixed. -1: a frame is missing, or
  // the two frames are fixed to different links.
  int eyes_link() const;
  // Bounding box of the collision shapes at the zero posture, in the root link's frame. The box is empty if
  // the robot has no collision shapes.
  Eigen::AlignedBox3d extent() const;
};

// Narrows the limits of each joint with followers, so that the followers' limits of angle and speed hold. The
// leader's torque alone cannot exceed a follower's effort.
// Returns the index of the first follower that leaves its leader no range.
std::optional<std::size_t> narrow_for_followers(std::vector<RobotJoint>& joints);

// Softness with which the gait was repeatable (static sinkage of 0.25 mm). The friction is above that of any
// floor, so that the floor's counts (the smaller mu of a pair).
inline constexpr Surface kRobotSurface{.mu = 1.0, .softness = 5e-3};
// A lighter link is a frame: exporters write such masses for links without a body.
inline constexpr double kLightestLink = 1e-9;  // kg

// Loads and checks a URDF or, if the root element is <mujoco>, an MJCF. The error names file and line of the
// first objection. Its details are the others.
Result<RobotModel> load_robot(const std::string& path, const ReadOptions& options = {});

}  // namespace kaz::sim
