// A moving robot loses its host, its line, its power, again and again at random moments.
// SPDX-License-Identifier: Apache-2.0
//
// Emulated firmware, physics, and the host's own client in lockstep. In each round the robot moves its
// joints until something happens to it; then the motors have to be safe in time, and the client has
// to come back by itself and start from where the joints are.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::campaign {

struct Options {
  std::string image_path, world_path, robot_path, camera_path;
  int rounds = 1000;
  std::uint64_t seed = 1;
  std::function<void(int done, int total)> progress;
};

// What happened to the robot: name of the event and of the link watchdog's reaction.
struct Tally {
  int rounds = 0;
  // From the last good frame's last byte (reset, power: from the event) until the motors are off or
  // the commands stand still.
  double worst_reaction_ms = 0;
  double worst_resume_ms = 0;   // from the end of the outage until the client moves on
  double worst_jump_mrad = 0;   // between command and angle of a joint that is switched on
  double worst_creep_mrad = 0;  // of a command that should stand still
};

struct Report {
  std::map<std::string, Tally> tallies;
  std::vector<std::string> failures;  // one sentence a round that went wrong
  bool passed() const { return failures.empty(); }
  std::string text() const;
};

// Errors: files, a chip that stopped.
Result<Report> run_campaign(const Options& options);

}  // namespace kaz::campaign
