// Runs the host alone against a recording, and compares what it sends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "sim/runtime/formats/mcap_reader.h"
#include "tools/app/replay/replay.h"
#include "tools/app/session/session.h"

namespace kaz::tools {

// Whether it can be done: it has pictures, or the behaviour needs none.
Result<bool> host_can_run_alone(const sim::McapRecording& recording, const std::string& behavior);

// Prints the result. False: the host did something else. `session` says what runs. Errors: a
// recording that cannot be read, or without the pictures that the behaviour needs.
Result<bool> replay_host(const ReplayOptions& options, const sim::McapRecording& recording,
                         SessionOptions session);

}  // namespace kaz::tools
