// One run of a walking behaviour on a virtual robot: what is asked of it, and what came of it.
// SPDX-License-Identifier: Apache-2.0
//
// The behaviour is the product's, over the simulated line of 115,200 baud to the emulated firmware, and
// knows only potentiometers and gyro. The simulator's truth is read for the score alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tests/studies/gait/results.h"

namespace kaz::walking {

using gait::Outcome;

enum class Judged { walk, turn, stand, get_up };

struct Trial {
  std::string name = {};
  Judged judged = Judged::walk;
  std::string behavior = "go-forward";  // or turn-left, turn-right, stand
  std::map<std::string, std::string> options = {};
  double distance = 1.0;    // m, of walk
  double turn_deg = 45;     // of turn, + to the left
  double mu = 0.7;          // of the floor
  double mu_spread = 0.15;  // one sigma over seeds, as a share of it
  double supply_volts = 10;
  bool imu = true;  // the board has the option
  std::string sensors = "nominal";
  double push_ns = 0;  // on the trunk, every push_every_s
  std::optional<double> push_to_deg =
      {};  // against ahead, + to the left; none: any way, by the seed
  double push_every_s = 1.5;
  // Before the behaviour begins: motors off and a push of 0.5 Ns that way, 20 degrees (one sigma) beside.
  std::optional<double> knocked_to_deg = {};
  // Whoever falls is watched to the behaviour's own end: figures `seen_to_fall`, which the behaviour says,
  // and `current_a`, then, of all motors together.
  bool to_the_end = false;
};

struct Setting {
  std::string engine = "h8";  // or "native"
  std::string image_path, robot_folder;
  bool trace = false;  // a line for each 0.1 s on standard error
};

// forward_m, aside_m, heading_deg: where the trunk is at the end, against where it was and faced when
// the motion began. Errors: files; the board stopped or refused.
Result<Outcome> run_trial(const Trial& trial, const Setting& setting, std::uint64_t seed);

// All that the table shows.
const std::vector<Trial>& trials();

}  // namespace kaz::walking
