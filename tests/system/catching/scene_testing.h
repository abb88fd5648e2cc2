// A robot, a floor and balls for behaviours that catch, and what can be done to them meanwhile.
// SPDX-License-Identifier: Apache-2.0
//
// The behaviour is the product's, through host, line, firmware and the eyes' pictures. The truth is
// read for the answer alone. m, s; world: x ahead of where the robot starts, y left.
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

struct Kick {  // velocity that is added
  double time_s = 0;
  Eigen::Vector3d velocity{0, 0, 0};
};

struct Scene {
  std::string behavior = "catch-ball";
  std::map<std::string, std::string> options = {};
  sim::McuKind mcu = sim::McuKind::native;
  sim::EyeKind eyes = sim::EyeKind::ideal;
  bool has_ball = true;
  Eigen::Vector2d ball{0.3, 0.1};  // red
  double radius = 0.020;
  std::vector<Kick> kicks = {};
  double rolling_resistance = 0.0005;          // m
  std::vector<Eigen::Vector2d> other_balls{};  // blue
  double frozen_from_s = 0, frozen_for_s = 0;  // no picture comes
  std::vector<std::string> faults = {};        // docs/reference/faults.md
  // Begins when the behaviour first says so; the fault without `at`.
  std::string fault_phase = {}, fault_then = {};
  std::uint64_t seed = 1;
};

struct Ending {
  behavior::Outcome outcome;
  std::vector<std::string> phases;
  bool fell = false;
  Eigen::Vector3d ball{0, 0, 0};
  double walked_while_frozen = 0;  // m, of the trunk, from 0.5 s after the pictures stopped
  double seconds = 0;

  bool did(std::string_view phase) const;
  int times(std::string_view phase) const;
};

// Errors: files; the board or the camera stopped.
Result<Ending> play(const Scene& scene);

}  // namespace kaz::catching
