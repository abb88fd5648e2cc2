// For tests: runs a behavior that catches balls in a scene with faults and kicks.
// SPDX-License-Identifier: Apache-2.0
//
// The product's behavior runs through host, line, firmware and the eyes' pictures. Ground truth is only used
// for the result. Units m, s. World frame: x ahead of the robot's start, y left.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "host/behavior/behavior.h"
#include "sim/mcu/mcu_kind.h"
#include "sim/runtime/eyes/eye_kind.h"

namespace kaz::catching {

struct Kick {  // adds a velocity to the red ball, m/s
  double time_s = 0;
  Eigen::Vector3d velocity{0, 0, 0};
};

struct Scene {
  std::string behavior = "catch-ball";
  std::map<std::string, std::string> options = {};
  sim::McuKind mcu = sim::McuKind::native;
  sim::EyeKind eyes = sim::EyeKind::ideal;
  bool has_ball = true;
  Eigen::Vector2d ball{0.3, 0.1};  // position of the red ball
  double radius = 0.020;           // radius of every ball
  std::vector<Kick> kicks = {};
  double rolling_resistance = 0.0005;          // m
  std::vector<Eigen::Vector2d> other_balls{};  // positions of blue balls
  double frozen_from_s = 0, frozen_for_s = 0;  // the camera delivers no pictures
  std::vector<std::string> faults = {};        // docs/reference/simulator.md
  // The fault `fault_then`, without `at`, begins when the behavior first enters the phase `fault_phase`.
  std::string fault_phase = {}, fault_then = {};
  std::uint64_t seed = 1;
};

struct Ending {
  behavior::Outcome outcome;
  std::vector<std::string> phases;
  bool fell = false;
  Eigen::Vector3d ball{0, 0, 0};   // position at the end
  double walked_while_frozen = 0;  // distance of the trunk, from 0.5 s after the pictures stopped
  double seconds = 0;

  // Return whether, and how often, the behavior entered a phase.
  bool did(std::string_view phase) const;
  int times(std::string_view phase) const;
};

// Errors: those of files; the board or the camera stopped.
Result<Ending> play(const Scene& scene);

}  // namespace kaz::catching
