// The true poses in a recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "shared/base/time.hpp"
#include "sim/runtime/formats/mcap_reader.h"

namespace kaz::tools {

// Of one time, in the world.
struct RecordedPoses {
  Time time{};
  std::vector<Eigen::Isometry3d> frames;  // in the order asked for
};

// Of these frames, from /tf, in order of time; at least one. Messages with none of them, such as that of a
// map, are skipped. Errors (usage) name the recording: it has no poses; a message does not fit its schema,
// lacks one of the frames, or is not later than the one before; a pose is no rotation, or above 1 km away.
Result<std::vector<RecordedPoses>> recorded_poses(const sim::McapRecording& recording,
                                                  std::span<const std::string> frames,
                                                  const std::string& name);

}  // namespace kaz::tools
