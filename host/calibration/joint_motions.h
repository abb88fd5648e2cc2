// What `kaz calibrate joints` moves, as data: the presses against stops, and the postures on the floor.
// SPDX-License-Identifier: Apache-2.0
//
// Angles in degrees, spread and roll of a limb outward from the body, as for get-up.
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

// One posture of the suspended robot; the joints of `presses` then go on against their stops, all at once.
struct StopStep {
  host::JointAngles posture{};  // rad
  std::vector<Press> presses;   // empty: on the way
};

// What the wizard asks about at once.
struct MotionGroup {
  const char* name;  // "arms"
  const char* text;  // what moves, for whoever stands by
  std::vector<StopStep> steps;
};

// Head and hands, arms, legs: both stops of every joint once.
std::span<const MotionGroup> stop_groups();

// Standing on both soles: crouches, leans, and the weight to each side.
std::span<const motion::Stance> floor_stances();
// All joints for a stance, arms as in motion::home().
host::JointAngles posture_of(const motion::Stance& stance);

}  // namespace kaz::calibration
