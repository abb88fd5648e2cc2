// Reads the true poses in a recording.
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

// Poses at one time, in the world frame.
struct RecordedPoses {
  Time time{};
  std::vector<Eigen::Isometry3d> frames;  // poses of the requested frames, in the requested order
};

// Returns the poses of `frames` from the topic /tf in order of time. The result has at least one entry. Skips
// messages that contain none of the frames, such as messages of a map. Fails (usage) if there are no poses.
// Fails if a message does not fit its schema, lacks one of the frames, or is not later than the previous
// message. Also fails if a quaternion is no rotation, or if a coordinate exceeds 1 km.
Result<std::vector<RecordedPoses>> recorded_poses(const sim::McapRecording& recording,
                                                  std::span<const std::string> frames,
                                                  const std::string& name);

}  // namespace kaz::tools
