// The host's side of a recording: bytes of both directions, pictures, the behaviour's record.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/faults/faults.h"
#include "sim/mcu/mcu.h"
#include "sim/runtime/formats/mcap_reader.h"
#include "vision/image/frame.h"

namespace kaz::lockstep {

struct RecordedRun {
  // Of one exposure, as the host got it.
  struct Pair {
    std::uint64_t sequence = 0;
    Time exposure{}, arrival{};
    std::vector<std::uint8_t> left_png, right_png;
  };
  struct Thought {  // what the behaviour entered
    Time time{};
    std::string json;
  };

  std::vector<sim::SerialByte> to_board;  // as they reached the board
  std::vector<sim::SerialByte> to_host;   // as they left the board
  std::vector<Pair> pairs;                // in order of exposure
  std::vector<Thought> thoughts;
  sim::States end = 0;   // of the last step; of a recording that was cut off, the last whole one
  bool cut_off = false;  // the run went on after `end`
  std::string interrupted_by;  // if that was a signal: "SIGINT"
  std::uint64_t seed = 1;      // of the line's faults
  faults::Schedule faults;
  bool has_pictures = false;
  vision::CameraModel camera;  // where there are pictures
  Time camera_latency{};

  // `name`: for the errors (usage): damaged, messages that do not fit their schema, cut off before
  // its first whole step.
  static Result<RecordedRun> of(const sim::McapRecording& recording,
                                const std::string& name = "the recording");
};

}  // namespace kaz::lockstep
