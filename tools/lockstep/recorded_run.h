// Decodes those contents of a recording that a replay needs: serial bytes, pictures, entries of the behavior.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/faults/faults.h"
#include "sim/mcu/mcu.h"
#include "sim/runtime/formats/mcap_reader.h"
#include "vision/image/frame.h"

namespace kaz::lockstep {

struct RecordedRun {
  // A stereo pair that the host received.
  struct Pair {
    std::uint64_t sequence = 0;
    Time exposure{}, arrival{};
    std::vector<std::uint8_t> left_png, right_png;
  };
  struct Thought {  // an entry of the behavior
    Time time{};
    std::string json;
  };

  std::vector<sim::SerialByte> to_board;  // each byte has the time of its arrival at the board
  std::vector<sim::SerialByte> to_host;   // each byte has the time of its departure from the board
  std::vector<Pair> pairs;                // in order of exposure
  std::vector<Thought> thoughts;
  sim::States end = 0;   // end of the last completely recorded step
  bool cut_off = false;  // true: the file is truncated, or the run was interrupted
  // Signal that interrupted the run, such as "SIGINT"; empty: no signal.
  std::string interrupted_by;
  std::uint64_t seed = 1;  // seed of the line faults
  faults::Schedule faults;
  bool has_pictures = false;
  vision::CameraModel camera;  // valid if has_pictures
  Time camera_latency{};

  // Decodes a recording. `name` identifies the recording in error messages. Returns Fault::usage if a chunk
  // is damaged, a message does not fit its schema, a pair is incomplete, or no step is recorded completely.
  static Result<RecordedRun> of(const sim::McapRecording& recording,
                                const std::string& name = "the recording");
};

}  // namespace kaz::lockstep
