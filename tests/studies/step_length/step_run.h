// One run of the whole virtual robot under a physics step of a given length, and how far two runs are
// result.
// SPDX-License-Identifier: Apache-2.0
//
// Host, wire, native firmware with its tick of 1 ms, sensors without noise, Kaz's motors. Targets are
// those of sim/body/world/gait_testing.h, sent each 20 ms as ramps of 20 ms.
#pragma once

#include <array>
#include <map>
#include <string>

#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::step_length {

enum class Load {
  stand,  // into the walking crouch within 2 s, and held
  walk,   // then steps on the spot, growing within 2 s
};

struct Setting {
  Load load = Load::stand;
  double step_ms = 1;
  double seconds = 6;
  std::string stepper = "reduced";
  double gain = 20;       // of full drive per rad
  double damping = 0.15;  // of full drive per rad/s
  double lead_ms = 0;     // delay of the first targets
};

struct Sample {
  std::array<double, KZ_JOINTS> angle{}, target{};  // rad
  Eigen::Isometry3d trunk = Eigen::Isometry3d::Identity();
  Eigen::Vector3d ball = Eigen::Vector3d::Zero();
  double left = 0, right = 0;  // N, of the floor on the feet, upwards
};

struct Course {
  std::map<int, Sample> at;  // by ms since the targets began
  double weight = 0;         // N
  double physics_s = 0;      // wall time in all
  double max_tilt = 0;       // rad, of the trunk
};

// The same without sources of chaotic divergence: motors without backlash, and a servo at 1 kHz with exact
// angles (between steps extrapolated by the velocity at the last step's end, as Simulation does) whose duty
// is averaged over a step. Errors: World's.
Result<Course> run_smooth(const Setting& setting);

// A ball of 40 mm rolls beside the robot meanwhile. Errors: Simulation's and the host's.
Result<Course> run(const Setting& setting);

struct Deviation {
  double joints = 0;    // rad, root mean square
  double tracking = 0;  // rad, root mean square of angle - target in the first of the two
  double trunk = 0;     // m, max distance of its positions
  double heading = 0;   // rad, max difference of its heading
  double force = 0;     // relative to the weight: root mean square over feet, means of 20 ms
  double ball = 0;      // m, max distance of its positions
};
Deviation deviation(const Course& run, const Course& reference);

}  // namespace kaz::step_length
