// Runs one episode of a walking behavior on a virtual robot: trial, settings and outcome.
// SPDX-License-Identifier: Apache-2.0
//
// The product's behavior runs over the simulated line of 115,200 baud to the emulated firmware. Its only
// sensors are potentiometers and gyro. Ground truth is only used for the outcome.
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
  bool imu = true;  // the board has an IMU
  sim::SensorSet sensors = sim::SensorSet::nominal;
  bool calibrated = false;  // kaz calibrate joints has run on this robot
  double push_ns = 0;       // impulse on the trunk, N s, every push_every_s
  // Direction of the pushes: 0 is ahead, > 0 to the left. nullopt: random by seed.
  std::optional<double> push_to_deg = {};
  double push_every_s = 1.5;
  bool push_sides = false;   // pushes to the left or right, by seed
  double push_jitter_s = 0;  // maximum change of the time of each push, by seed
  double most_s = 0;         // timeout of the motion; 0: none
  // Before the behavior starts, motors are off and a push of 0.5 N s acts in this direction, with noise of 20
  // degrees (sigma).
  std::optional<double> knocked_to_deg = {};
  // After a fall the behavior continues to its own end. Then Outcome::reported contains `fall_detected` (by
  // the behavior) and `current_a` (sum over all motors).
  bool to_the_end = false;
};

struct Setting {
  sim::McuKind mcu = sim::McuKind::h8;
  std::string image_path, robot_folder;
  bool trace = false;  // prints a line every 0.4 s on standard error
};

// Returns the outcome; forward_m, aside_m and heading_deg are those at the end, relative to the start of the
// motion. Errors: those of files; the board stopped or refused.
Result<Outcome> run_trial(const Trial& trial, const Setting& setting, std::uint64_t seed);

// Returns all trials of the table.
const std::vector<Trial>& trials();

}  // namespace kaz::walking
