// Limits, motors and couplings of the joints of an MJCF robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/body/description/mjcf_compile.h"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {

class MjcfJoints {
 public:
  MjcfJoints(const Mjcf& mjcf, const CompiledMjcf& compiled, Objections& objections);

  // Completes the joints of `robot`, which have names, axes and links. Adds limits, losses, efforts,
  // couplings and the order. The effort is the sum of the actuators' forces, also by tendons, at most
  // `actuatorfrcrange`. If the model has actuators, joints without one get a motor and a note. If two joints
  // are coupled, the joint with an actuator leads. Objections: joints without a name, couplings that are not
  // linear, and joints that follow two joints or each other.
  void finish(RobotModel& robot);

 private:
  struct Coupling {
    int leader = 0;  // joint of the model
    double ratio = 1, offset = 0;
  };
  std::string name_of(int joint) const;
  const tinyxml2::XMLElement& element_of(int joint) const;
  void object(int joint, const std::string& text);
  void read_actuators();
  void read_tendon(int actuator);
  void pass_tendon_forces();
  double force_of(int actuator) const;
  void read_limits(int joint, RobotJoint& out);
  void read_couplings(const std::map<int, int>& number);
  void couple(int equality, int one, int two);
  Coupling resolved(int follower);
  void order(RobotModel& robot) const;
  void check_names(const RobotModel& robot);
  void check_followers(RobotModel& robot);  // narrows the limits of their leaders

  const Mjcf& mjcf_;
  const mjModel_& model_;
  const CompiledMjcf& compiled_;
  Objections& objections_;
  std::map<int, double> force_;        // Nm, by joint of the model with an actuator
  std::map<int, double> pull_;         // the same, by tendons
  std::map<int, Coupling> couplings_;  // by follower
};

}  // namespace kaz::sim
