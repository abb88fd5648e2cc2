// Campaign in which a moving robot loses its host, line or power at random times.
// SPDX-License-Identifier: Apache-2.0
//
// Emulated firmware, physics, and the host's own client run in lockstep. In each round the robot moves its
// joints until an event. Then the motors must become safe in time. Afterwards the client must reconnect by
// itself and start from the joints' actual angles.
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
  // From the last byte of the last valid frame until the motors are off or the commands stand still. After a
  // reset or power cut: from the event.
  double max_reaction_ms = 0;
  double max_resume_ms = 0;   // from the end of the outage until the client moves joints again
  double max_jump_mrad = 0;   // between command and angle of a joint that is switched on
  double max_creep_mrad = 0;  // motion of a command that should stand still
};

struct Report {
  std::map<std::string, Tally> tallies;
  std::vector<std::string> failures;  // one sentence for each violation
  bool passed() const { return failures.empty(); }
  std::string table() const;  // Markdown, a row for each event
  std::string text() const;   // table and failures
};

// Errors: those of files, and a chip that stopped.
Result<Report> run_campaign(const Options& options);

}  // namespace kaz::campaign
