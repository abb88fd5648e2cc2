// Behaviours: programs that move a robot by what it sees, written once for real and virtual robots.
// SPDX-License-Identifier: Apache-2.0
//
// A behaviour is plain code against Context. It waits only through the robot and the clock, so it
// ends with an error as soon as the link fails, the camera stops or the program is interrupted; it
// leaves the motors as they are, and whoever ran it calls Robot::disable_all() at the end.
// docs/host.md shows how to write one.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/behavior/ball_sight.h"
#include "host/behavior/options.h"
#include "host/behavior/sink.h"
#include "host/robot/robot.h"

namespace kaz::behavior {

struct Context {
  host::Robot& robot;
  host::Clock& clock;
  BallSight* sight;  // null if there is no camera: only for behaviours whose needs_sight is false
  Sink& sink;
  OptionValues options;
  std::uint64_t seed = 1;  // of whatever a behaviour leaves to chance
  // Of a robot that is no Kaz: its joints, on the first channels of the board. Empty: Kaz's.
  std::vector<std::string> other_joints = {};
  double ball_radius_m = 0.020;  // of the ball that `sight` looks for
};

// How it ended. Figures go into result.json under their names, which carry their units.
struct Outcome {
  bool success = false;
  std::string sentence;  // for people: "the ball was found after 1.4 s"
  std::vector<std::pair<std::string, double>> figures;
  // Of a failure, in a word or two that are the same each time: for tables. "not found".
  std::string cause = {};
};

struct Behavior {
  std::string_view name;  // "track-ball"
  std::string_view text;  // one line
  bool needs_sight = false;
  std::span<const Option> options;
  // An outcome without success means that the task failed; an Error, that it could not be tried to
  // the end.
  Result<Outcome> (*run)(Context& context) = nullptr;
};

// All behaviours, by name.
std::span<const Behavior> behaviors();
// Fails (usage) with a sentence that lists the names.
Result<Behavior> find_behavior(std::string_view name);

}  // namespace kaz::behavior
