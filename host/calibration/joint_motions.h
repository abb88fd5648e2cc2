// Motions of `kaz calibrate joints`, as data: the presses against stops, and the postures on the floor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "host/calibration/pot_model.h"
#include "host/motion/gait.h"

namespace kaz::calibration {

struct Press {
  host::Joint joint;
  Stop stop;
};

// A posture of the suspended robot. From this posture, all joints in `presses` move against their stops at
// the same time.
struct StopStep {
  host::JointAngles posture{};  // rad
  std::vector<Press> presses;   // empty: the robot only moves to the posture
};

// Motions that the user confirms together before they start.
struct MotionGroup {
  const char* name;  // "arms"
  const char* text;  // description of the motion for the user
  std::vector<StopStep> steps;
};

// Returns three groups: head and hands, arms, legs. Together, the groups press each joint once against its
// lower stop and once against its upper stop.
std::span<const MotionGroup> stop_groups();

// Returns stances on both soles: crouches, leans, and stances with the weight shifted to one side.
std::span<const motion::Stance> floor_stances();
// Returns all joint angles for a stance, rad, with the arms as in motion::home().
host::JointAngles posture_of(const motion::Stance& stance);

}  // namespace kaz::calibration
