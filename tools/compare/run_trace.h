// Run as observed on the wire: commands, postures, replies and pictures from a recording.
// SPDX-License-Identifier: Apache-2.0
// A trace contains the same data for a virtual robot and for a robot at a port: the simulator's ground truth
// is not read.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "sim/runtime/formats/mcap_reader.h"

namespace kaz::tools {

// Times are in s since the first record of the behavior. If there are no such records, times count from the
// start of the recording.
struct RunTrace {
  std::string name;      // the `name` passed to of(); load() passes the path of the file
  std::string behavior;  // name of the behavior; empty if unknown
  std::string settings;  // settings of the behavior as JSON
  std::string robot;     // "virtual" or the port
  double duration_s = 0;
  std::string early_end;  // reason why the recording ends before the run; empty if the recording is complete

  struct Posture {
    // Time of the board's tick in which the angles were measured. The fastest replies align the board's clock
    // with the recording's clock.
    double time_s = 0;
    std::array<double, KZ_JOINTS> angle_rad{};
    double supply_v = 0;
  };
  std::vector<Posture> postures;

  struct Targets {
    // Time at which the request had arrived at the board, estimated from the traffic on the wire.
    double time_s = 0;
    double ramp_s = 0;
    std::uint32_t mask = 0;
    std::array<double, KZ_JOINTS> angle_rad{};  // valid for the joints in `mask`
  };
  std::vector<Targets> targets;

  struct Exchange {
    double time_s = 0;        // time at which the request started
    double round_trip_s = 0;  // from the start of the request until the complete reply
  };
  std::vector<Exchange> exchanges;

  struct Picture {
    double exposure_s = 0;
    double delay_s = 0;  // from the exposure until the behavior received the result of vision
    bool found = false;  // the ball was found
  };
  std::vector<Picture> pictures;

  int unanswered = 0;  // requests without a reply
  int refused = 0;
  int damaged = 0;  // damaged frames in either direction
  // Reasons for shutdowns that the board reported, each reason once.
  std::vector<std::string> shutdowns;

  // Fails (usage) if the recording is damaged or contains no posture.
  static Result<RunTrace> of(const sim::McapRecording& recording, const std::string& name);
  // Loads the file at `path`, or recording.mcap if `path` is a folder.
  static Result<RunTrace> load(const std::string& path);
};

}  // namespace kaz::tools
