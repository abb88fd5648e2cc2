// `kaz vision run --in FILE.mcap` for recordings of other programs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "sim/runtime/formats/mcap_reader.h"
#include "tools/vision/modules.h"
#include "tools/vision_run/recorded_pictures.h"

namespace kaz::tools {

// Processes the stereo pairs of the topics in `options.topics` (picture_topics.h) like run_on_pairs(). The
// module `flow` gets the times of the pictures; modules that need a posture are rejected. Fails (usage) if
// the recording has no pairs.
Result<bool> run_on_others_recording(const RecordedOptions& options,
                                     const sim::McapRecording& recording,
                                     const VisionOptions& vision);

}  // namespace kaz::tools
