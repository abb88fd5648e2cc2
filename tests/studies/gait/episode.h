// One run of the robot through host, wire and firmware: what is asked of it, and what came of it.
// SPDX-License-Identifier: Apache-2.0
//
// Targets leave at 50 Hz over the simulated serial line, each a ramp of 20 ms of the firmware; gains are
// set by the protocol. Feedback and scores use the simulator's ground truth: the heading with 0.02 rad of
// noise stands in for a gyro, the way walked for odometry.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"
#include "tests/studies/gait/disturbed.h"
#include "tests/studies/gait/gait.h"

namespace kaz::gait {

enum class Kind {
  walk,   // straight ahead for `distance`
  turn,   // by `turn`, judged by the heading
  spin,   // cycles of turning without feedback
  stand,  // in the crouch
  grab,   // the ball is picked up
};

struct Task {
  std::string name = {};
  Kind kind = Kind::walk;
  Shape shape = {};
  double mu = 0.7;
  double distance = 0.5;  // m
  bool hold_heading = true;
  double turn = 0;  // rad, + to the left
  int cycles = 3;   // of spin
  double push_ns = 0, push_every_s = 1.7;
  // Where the ball is beside its assumed place, m: one of these, by the seed's turn; 3 mm more by chance.
  std::vector<Eigen::Vector2d> off = {};
  std::string reference = {};  // what the gait did where it was found, in words
};

struct Setting {
  std::string stepper = "reduced";
  std::string engine = "h8";  // or "native"
  std::string image_path;     // firmware, for "h8"
  std::string robot_folder;   // of kaz.urdf
  Motors motors = Motors::product;
};

struct Outcome {
  bool fell = false;
  double seconds = 0;                      // of the motion, ramps included
  double forward_m = 0, aside_m = 0;       // of the trunk at the end; largest on the way
  double heading_deg = 0;                  // at the end, + to the left
  double tilt_deg = 0;                     // largest on the way, of the trunk, against the vertical
  double hottest_celsius = 0;              // of any winding at the end
  std::vector<double> per_cycle_deg = {};  // spin: turned in each cycle
  bool caught = false;
  double grasp_mm = 0;  // ball from the centre of the grasp, at the end
  std::vector<std::pair<double, double>> path = {};  // of the trunk, mm, each 0.2 s
  std::map<std::string, double> figures = {};        // what the robot itself says of it
};

// Errors: files; the board stopped or refused.
Result<Outcome> run_episode(const Task& task, const Setting& setting, std::uint64_t seed);

// All that the tables show.
const std::vector<Task>& tasks();

}  // namespace kaz::gait
