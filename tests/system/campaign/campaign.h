// A moving robot repeatedly loses its host, its line or its power at random times.
// SPDX-License-Identifier: Apache-2.0
//
// Emulated firmware, physics, and the host's own client in lockstep. In each round the robot moves its
// joints until an event; then the motors have to be safe in time, and the client has to reconnect by itself
// and start from the joints' actual angles.
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

// Statistics of one kind of event and reaction of the link watchdog.
struct Tally {
  int rounds = 0;
  // From the last good frame's last byte (reset, power: from the event) until the motors are off or
  // the commands stand still.
  double max_reaction_ms = 0;
  double max_resume_ms = 0;   // from the end of the outage until the client moves on
  double max_jump_mrad = 0;   // between command and angle of a joint that is switched on
  double max_creep_mrad = 0;  // of a command that should stand still
};

struct Report {
  std::map<std::string, Tally> tallies;
  std::vector<std::string> failures;  // one sentence a round that went wrong
  bool passed() const { return failures.empty(); }
  std::string table() const;  // Markdown, a row for each event
  std::string text() const;   // the table, and the failures
};

// Errors: files, a chip that stopped.
Result<Report> run_campaign(const Options& options);

}  // namespace kaz::campaign
