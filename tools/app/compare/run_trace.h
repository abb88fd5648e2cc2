// What a recording says of a run to someone who has only the wire: commands, postures, replies, pictures.
// SPDX-License-Identifier: Apache-2.0
//
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

// Times in s from the behaviour's first record; without one, from the recording's begin.
struct RunTrace {
  std::string name;      // as given
  std::string behavior;  // empty: not known
  std::string settings;  // JSON
  std::string robot;     // "virtual", or the port
  double duration_s = 0;
  std::string early_end;  // why the recording ends before the run; empty: it does not

  struct Posture {
    double time_s =
        0;  // when the angles were measured: the board's tick, set to the earliest arrivals
    std::array<double, KZ_JOINTS> angle_rad{};
    double supply_v = 0;
  };
  std::vector<Posture> postures;

  struct Targets {
    double time_s = 0;  // when the request had arrived at the board, as far as the wire shows
    double ramp_s = 0;
    std::uint32_t mask = 0;
    std::array<double, KZ_JOINTS> angle_rad{};  // of the joints in the mask
  };
  std::vector<Targets> targets;

  struct Exchange {
    double time_s = 0;        // of the request
    double round_trip_s = 0;  // until its reply was there
  };
  std::vector<Exchange> exchanges;

  struct Picture {
    double exposure_s = 0;
    double delay_s = 0;  // until the behaviour had what vision makes of it
    bool found = false;  // the ball
  };
  std::vector<Picture> pictures;

  int unanswered = 0;  // requests without reply
  int refused = 0;
  int damaged = 0;                     // frames, in either direction
  std::vector<std::string> shutdowns;  // reasons that the board gave, each once

  // Errors (usage), one sentence: nothing to compare in it, damaged.
  static Result<RunTrace> of(const sim::McapRecording& recording, const std::string& name);
  // Of a file, or of recording.mcap in a folder.
  static Result<RunTrace> load(const std::string& path);
};

}  // namespace kaz::tools
