// One episode of a walking behaviour on a virtual robot: trial, settings and outcome.
// SPDX-License-Identifier: Apache-2.0
//
// The behaviour is the product's, over the simulated line of 115,200 baud to the emulated firmware; its only
// sensors are potentiometers and gyro. The simulator's ground truth is used for the outcome only.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/board/sensor_file.h"
#include "sim/mcu/mcu_kind.h"
#include "tests/studies/common/episode_file.h"

namespace kaz::walking {

using studies::Outcome;

enum class Judged { walk, turn, stand, get_up };

struct Trial {
  std::string name = {};
  Judged judged = Judged::walk;
  std::string behavior = "go-forward";  // or turn-left, turn-right, stand
  std::map<std::string, std::string> options = {};
  double distance = 1.0;    // m
  double turn_deg = 45;     // > 0 to the left
  double mu = 0.7;          // friction of the floor, mean over seeds
  double mu_spread = 0.15;  // standard deviation relative to `mu`
  double supply_volts = 10;
  bool imu = true;  // the board has the option
  sim::SensorSet sensors = sim::SensorSet::nominal;
  bool calibrated = false;  // kaz calibrate joints has run on this robot
  double push_ns = 0;       // on the trunk, every push_every_s
  // Direction of the pushes, 0 is ahead, > 0 to the left; none: random by seed.
  std::optional<double> push_to_deg = {};
  double push_every_s = 1.5;
  bool push_sides = false;   // to the left or the right, by seed
  double push_jitter_s = 0;  // the time of each moves by up to so much, by seed
  double most_s = 0;         // ends the walk; 0: none
  // Before the behaviour starts: motors off and a push of 0.5 Ns in this direction, plus 20 degrees (sigma).
  std::optional<double> knocked_to_deg = {};
  // After a fall the behaviour runs to its own end. Outcome::reported then has `fall_detected` (by the
  // behaviour) and `current_a` (sum of all motors).
  bool to_the_end = false;
};

struct Setting {
  sim::McuKind mcu = sim::McuKind::h8;
  std::string image_path, robot_folder;
  bool trace = false;  // a line for each 0.1 s on standard error
};

// forward_m, aside_m, heading_deg: trunk pose at the end relative to its pose at the start of the motion.
// Errors: files; the board stopped or refused.
Result<Outcome> run_trial(const Trial& trial, const Setting& setting, std::uint64_t seed);

// All trials of the table.
const std::vector<Trial>& trials();

}  // namespace kaz::walking
