// Runs one episode of the robot through host, wire and firmware: task, settings and outcome.
// SPDX-License-Identifier: Apache-2.0
//
// Targets are sent at 50 Hz over the simulated serial line, and each is a ramp of 20 ms in the firmware.
// Gains are set through the protocol. Feedback and outcome use ground truth. Heading with noise of 0.02 rad
// (sigma) replaces a gyro, and distance walked replaces odometry.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/mcu/mcu_kind.h"
#include "tests/studies/common/disturbed_robot.h"
#include "tests/studies/common/episode_file.h"
#include "tests/studies/gait/gait.h"

namespace kaz::gait {

using studies::Motors;
using studies::Outcome;

enum class Kind {
  walk,   // straight ahead for `distance`
  turn,   // by `turn`, with feedback of the heading
  spin,   // `cycles` of turning without feedback
  stand,  // in the crouch
  grab,   // pick up the ball
};

struct Task {
  std::string name = {};
  Kind kind = Kind::walk;
  Shape shape = {};
  double mu = 0.7;
  double distance = 0.5;  // m
  bool hold_heading = true;
  double turn = 0;  // rad, > 0 to the left
  int cycles = 3;
  double push_ns = 0, push_every_s = 1.7;
  // Offsets of the ball from its assumed position, m. The seed selects one, with noise of 3 mm (sigma).
  std::vector<Eigen::Vector2d> off = {};
  std::string reference = {};  // results in the simulator in which the gait was found, as text
};

struct Setting {
  std::string stepper = "reduced";
  sim::McuKind mcu = sim::McuKind::h8;
  std::string image_path;    // firmware, for h8
  std::string robot_folder;  // folder of kaz.urdf
  Motors motors = Motors::product;
};

// Errors: those of files; the board stopped or refused.
Result<Outcome> run_episode(const Task& task, const Setting& setting, std::uint64_t seed);

// Returns all tasks of the tables.
const std::vector<Task>& tasks();

}  // namespace kaz::gait
