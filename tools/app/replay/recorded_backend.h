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
#include "tools/app/session/backend_options.h"
#include "vision/color/ball.h"

namespace kaz::tools {

struct RecordedBackend {
  std::string behavior;
  std::map<std::string, std::string> settings;  // options of the behavior
  BackendOptions backend;                       // options of the simulated robot
  vision::BallOptions ball;                     // ball for which vision looked
};

// `name`: name of the recording for errors. Fails (usage) if the recording lacks its options or contains
// invalid ones, or if it was made at a port.
Result<RecordedBackend> recorded_backend(const sim::McapRecording& recording,
                                         const std::string& name);

// Returns the manual actions (sim/runtime/simulation/hand_player.h) with their times in ns, in order.
std::vector<std::pair<std::uint64_t, std::string>> recorded_acts(
    const sim::McapRecording& recording);

// Returns the requests to the behavior (behavior::Requests) with their times in ns, in order.
std::vector<std::pair<std::uint64_t, std::string>> recorded_requests(
    const sim::McapRecording& recording);

// Returns the phases of the behavior, as "search", with their start times in ns, in order.
std::vector<std::pair<std::uint64_t, std::string>> recorded_phases(
    const sim::McapRecording& recording);

// Replaces paths of world and robot files that no longer exist. Searches the folder of the recording, where
// kaz evaluate stores them for failed episodes. Then searches its parent, in which the run may have been
// started.
void find_beside(BackendOptions& options, const std::string& recording);

}  // namespace kaz::tools
