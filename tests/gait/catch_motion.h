// Picking up a ball from the floor with the right hand: a known sequence, as joint angles over time.
// SPDX-License-Identifier: Apache-2.0
//
// Crouch with the arm forward and the hand open, swing the arm down onto the ball, close, lift, stand up.
// The hips' place is solved at each moment so that the centre of mass stays over the feet.
// Units m, s, rad; x forward, y left from the middle of the ankles.
#pragma once

#include <string>

#include "host/robot/posture.h"
#include "shared/base/result.hpp"
#include "sim/body/reduced/articulated_tree.h"
#include "sim/body/robot_model.h"

namespace kaz::gait {

using host::JointAngles;

class CatchMotion {
 public:
  // For a ball of radius 20 mm whose centre is assumed there, on the floor, to the right: y in -0.07 to
  // -0.02. Errors: the robot's file is no Kaz; out of the arm's reach.
  static Result<CatchMotion> plan(const sim::RobotModel& robot, double ball_x, double ball_y);

  double duration() const;  // s
  // Targets of the joints; before 0 and after the end those of the ends, which are standing.
  JointAngles at(double time_s);

  // Centre of what the jaws enclose, in the frame of the link `r_elbow`.
  static Eigen::Vector3d grasp() { return {0, 0, -0.093}; }

 private:
  struct Arm {
    double pitch = 0, roll = 0, elbow = 0;
  };
  struct Key {  // reached at its time
    double time = 0;
    double z = 0, pitch = 0, com_x = 0;  // of body and centre of mass
    Arm right, left;
    double hand = 0;
  };
  explicit CatchMotion(const sim::RobotModel& robot);
  JointAngles solve(const Key& key);
  Eigen::Vector3d grasp_at(const Key& key);
  Result<Arm> reach(Key key, const Eigen::Vector3d& target);
  double mass_centre_x(const JointAngles& angles, double x, const Key& key);

  sim::ArticulatedTree tree_;
  int forearm_ = 0;
  std::vector<Key> keys_;
};

}  // namespace kaz::gait
