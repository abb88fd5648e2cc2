// Run as observed on the wire: commands, postures, replies and pictures from a recording.
// SPDX-License-Identifier: Apache-2.0
// It is the same for recordings of a virtual robot and of a port: the simulator's ground truth is not read.
// The same of a virtual robot's recording and of one made at a port: the simulator's truth is not read.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "sim/runtime/formats/mcap_reader.h"

namespace kaz::tools {

// Times are in s since the first record of the behavior; without one, since the start of the recording.
struct RunTrace {
  std::string name;      // as passed to of(); load() passes the file
  std::string behavior;  // empty if unknown
  std::string settings;  // JSON
  std::string robot;     // "virtual", or the port
  double duration_s = 0;
  std::string early_end;  // why the recording ends before the run; else empty

  struct Posture {
    // When the angles were measured: the board's tick, aligned with the earliest arrivals.
    double time_s = 0;
    std::array<double, KZ_JOINTS> angle_rad{};
    double supply_v = 0;
  };
  std::vector<Posture> postures;

  struct Targets {
    // Time at which the request had arrived at the board, as far as the wire shows.
    double time_s = 0;
    double ramp_s = 0;
    std::uint32_t mask = 0;
    std::array<double, KZ_JOINTS> angle_rad{};  // for the joints in the mask
  };
  std::vector<Targets> targets;

  struct Exchange {
    double time_s = 0;        // start of the request
    double round_trip_s = 0;  // until the complete reply
  };
  std::vector<Exchange> exchanges;

  struct Picture {
    double exposure_s = 0;
    double delay_s = 0;  // until the behavior received the result of vision
    bool found = false;  // the ball was found
  };
  std::vector<Picture> pictures;

  int unanswered = 0;  // requests without a reply
  int refused = 0;
  int damaged = 0;                     // damaged frames in either direction
  std::vector<std::string> shutdowns;  // reasons that the board reported, each once

  // Fails (usage) if the recording is damaged or contains no posture.
  static Result<RunTrace> of(const sim::McapRecording& recording, const std::string& name);
  // Loads a file, or recording.mcap in a folder.
  static Result<RunTrace> load(const std::string& path);
};

}  // namespace kaz::tools
