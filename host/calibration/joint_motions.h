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

// A posture of the suspended robot. From it, the joints of `presses` move on against their stops, all at
// once.
struct StopStep {
  host::JointAngles posture{};  // rad
  std::vector<Press> presses;   // empty: only a posture on the way
};

// Motions that the user confirms together before they start.
struct MotionGroup {
  const char* name;  // "arms"
  const char* text;  // description of the motion for the user
  std::vector<StopStep> steps;
};

// Returns the groups head and hands, arms, legs. They press each joint against both stops once.
std::span<const MotionGroup> stop_groups();

// Returns stances on both soles: crouches, leans, and the weight shifted to each side.
std::span<const motion::Stance> floor_stances();
// Returns all joint angles for a stance, rad, with the arms as in motion::home().
host::JointAngles posture_of(const motion::Stance& stance);

}  // namespace kaz::calibration
