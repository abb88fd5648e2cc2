// Runs only the host, on recorded input, and compares the bytes that the host sends with the recorded bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "sim/runtime/formats/mcap_reader.h"
#include "tools/replay/replay.h"
#include "tools/run/run_plan.h"

namespace kaz::tools {

// Returns whether the recording has pictures, or the behavior needs no pictures.
Result<bool> host_can_run_alone(const sim::McapRecording& recording, const std::string& behavior);

// Prints the result. Returns false if the host acted differently than in the recording. `session`: the run to
// repeat. Fails if the recording cannot be read, or lacks pictures that the behavior needs.
Result<bool> replay_host(const ReplayOptions& options, const sim::McapRecording& recording,
                         RunOptions run_options);

}  // namespace kaz::tools
