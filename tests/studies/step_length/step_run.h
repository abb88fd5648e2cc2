// Runs the whole virtual robot with a given physics step, and computes the deviation between two runs.
// SPDX-License-Identifier: Apache-2.0
//
// It has host, wire, native firmware with its tick of 1 ms, sensors without noise, and Kaz's motors. Targets
// are those of sim/body/world/gait_testing.h, sent every 20 ms as ramps of 20 ms.
#pragma once

#include <array>
#include <map>
#include <string>

#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::step_length {

enum class Load {
  stand,  // moves into the walking crouch within 2 s and holds it
  walk,   // then steps on the spot, with full amplitude after 2 s
};

struct Setting {
  Load load = Load::stand;
  double step_ms = 1;
  double seconds = 6;
  std::string stepper = "reduced";
  double gain = 20;       // full drive per rad
  double damping = 0.15;  // full drive per rad/s
  double lead_ms = 0;     // delay of the first targets
};

struct Sample {
  std::array<double, KZ_JOINTS> angle{}, target{};  // rad
  Eigen::Isometry3d trunk = Eigen::Isometry3d::Identity();
  Eigen::Vector3d ball = Eigen::Vector3d::Zero();
  double left = 0, right = 0;  // upward force of the floor on each foot, N
};

struct Course {
  std::map<int, Sample> at;  // by ms since the targets began
  double weight = 0;         // N
  double physics_s = 0;      // wall time of the run
  double max_tilt = 0;       // maximum tilt of the trunk, rad
};

// Runs without host, firmware, and sources of chaotic divergence. Motors have no backlash. A servo at 1 kHz
// has exact angles, and its duty is averaged over a step. Between steps, angles are extrapolated with the
// last velocity, as in Simulation. Errors: those of World.
Result<Course> run_smooth(const Setting& setting);

// Runs with host and firmware. In both functions a ball of 40 mm diameter rolls beside the robot. Errors:
// those of Simulation and host.
Result<Course> run(const Setting& setting);

struct Deviation {
  double joints = 0;    // root mean square difference of joint angles, rad
  double tracking = 0;  // root mean square of angle - target in `run`, rad
  double trunk = 0;     // maximum distance of trunk positions, m
  double heading = 0;   // maximum difference of headings, rad
  // Root mean square difference of the feet's forces, averaged over 20 ms, relative to the weight.
  double force = 0;
  double ball = 0;  // maximum distance of ball positions, m
};
// Compares the times that both runs contain.
Deviation deviation(const Course& run, const Course& reference);

}  // namespace kaz::step_length
