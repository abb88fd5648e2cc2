// Options of a run, read from its recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/runtime/formats/mcap_reader.h"
#include "tools/run/backend_options.h"
#include "vision/color/ball.h"

namespace kaz::tools {

struct RecordedBackend {
  std::string behavior;
  std::map<std::string, std::string> settings;  // options of the behavior
  BackendOptions backend;                       // options of the simulated robot
  vision::BallOptions ball;                     // ball that vision looked for
};

// `name`: name of the recording for error messages. Fails (usage) if the recording contains no options or
// invalid options, or if the recording was made at a port.
Result<RecordedBackend> recorded_backend(const sim::McapRecording& recording,
                                         const std::string& name);

// Returns the manual actions (sim/runtime/simulation/hand_player.h) with their times in ns, in order.
std::vector<std::pair<std::uint64_t, std::string>> recorded_acts(
    const sim::McapRecording& recording);

// Returns the requests to the behavior (behavior::Requests) with their times in ns, in order.
std::vector<std::pair<std::uint64_t, std::string>> recorded_requests(
    const sim::McapRecording& recording);

// Returns the phases of the behavior, for example "search", with their start times in ns, in order.
std::vector<std::pair<std::uint64_t, std::string>> recorded_phases(
    const sim::McapRecording& recording);

// Replaces paths of world and robot files that no longer exist. First searches the folder of the recording,
// where `kaz evaluate` stores these files for failed episodes. Then searches the parent of this folder,
// because the run may have been started there.
void find_beside(BackendOptions& options, const std::string& recording);

}  // namespace kaz::tools
