// How a run was put together, as its recording states it.
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
  std::map<std::string, std::string> settings;  // of the behaviour
  BackendOptions backend;                       // the simulated robot's
  vision::BallOptions ball;                     // that vision looked for
};

// `name`: of the recording, for the errors (usage): it does not state its backend, or not as kaz does.
Result<RecordedBackend> recorded_backend(const sim::McapRecording& recording,
                                         const std::string& name);

// What was done by hand (sim/runtime/simulation/hand_player.h), with its time, ns, in order.
std::vector<std::pair<std::uint64_t, std::string>> recorded_acts(
    const sim::McapRecording& recording);

// What was asked of the behaviour (behavior::Requests), with its time, ns, in order.
std::vector<std::pair<std::uint64_t, std::string>> recorded_requests(
    const sim::McapRecording& recording);

// The behavior's phases, as "search", with the times of their beginnings, ns, in order.
std::vector<std::pair<std::uint64_t, std::string>> recorded_phases(
    const sim::McapRecording& recording);

// World and robot that are not where they were, and are beside the recording, as kaz evaluate keeps them of
// episodes that failed, or beside its folder, as where the run was started in the folder of its world.
void find_beside(BackendOptions& options, const std::string& recording);

}  // namespace kaz::tools
