// Finds the stereo pictures and the calibration in a recording of another program.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/runtime/formats/mcap_reader.h"
#include "vision/calibration/calibration.h"

namespace kaz::tools {

struct StereoTopics {
  std::string left, right;
};
// Returns the topics of the pictures. `given`: LEFT,RIGHT; if empty, the recording must have exactly one pair
// of picture topics whose names differ only by "left" and "right". Fails (usage) with a list of the topics
// and their encodings. `name`: name of the recording.
Result<StereoTopics> stereo_topics(const sim::McapRecording& recording, const std::string& name,
                                   const std::string& given);

struct RecordedEyes {
  vision::StereoCalibration calibration;
  // True: the pictures are rectified, because both topics have "image_rect" in their names (as in ROS).
  bool rectified = false;
};
// Returns the calibration in the file `calibration`; if empty, the calibration in the first messages of the
// topics "camera_info" beside the pictures. Fails (usage) if a calibration is missing or invalid.
Result<RecordedEyes> recorded_eyes(const sim::McapRecording& recording, const std::string& name,
                                   const StereoTopics& topics, const std::string& calibration);

struct RecordedPair {
  std::uint64_t stamp_ns = 0;  // exposure of the left picture; if unknown, the time of its message
  const sim::McapRecording::Message* left = nullptr;
  const sim::McapRecording::Message* right = nullptr;
};
struct RecordedPairs {
  std::vector<RecordedPair> pairs;  // by time
  std::size_t unpaired = 0;         // pictures without a partner
  std::size_t invalid = 0;          // messages that do not have the fields of their schema
};
// Two pictures are a pair if their times differ by at most 5 ms. The times of the pairs increase. `recording`
// must outlive the pairs.
RecordedPairs pairs_in(const sim::McapRecording& recording, const StereoTopics& topics);

}  // namespace kaz::tools
