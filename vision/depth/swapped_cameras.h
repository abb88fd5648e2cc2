// Detects swapped pictures of pairs: left and right camera plugged in the wrong way round.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vision/depth/depth.h"

namespace kaz::vision {

// By the depth that a pair has as it is and with left and right exchanged: of swapped pictures objects are
// further right in the right one, where no depth is looked for. `unclear`: hardly any depth either way, as
// in the dark or of a pattern that repeats, or a pair that cannot be compared at all (DepthFinder's errors).
enum class EyeOrder : std::uint8_t { unclear, as_named, swapped };

// Twice the work of one small depth image.
EyeOrder eye_order(const StereoImages& pair, const FrameInfo& info,
                   const DepthOptions& options = {});

// The verdict on a whole run: of one pair alone it may be wrong, and pictures may be disturbed for a while.
class SwappedCameras {
 public:
  static constexpr int kFirst = 5;
  static constexpr Time kInterval = std::chrono::milliseconds(500);

  explicit SwappedCameras(const DepthOptions& options = {}) : options_(options) {}

  // Looks at the first kFirst pairs, then at one per kInterval of exposure; others return at once.
  void look(const StereoImages& pair, const FrameInfo& info);
  // Two thirds of the pairs that show which is which are swapped. Where hardly any pair does, one or two of
  // them do not count.
  bool found() const;

 private:
  DepthOptions options_;
  Time next_{};
  int looked_ = 0, as_named_ = 0, swapped_ = 0;
};

// For people, where found().
inline constexpr const char* kSwappedCameras =
    "left and right look exchanged: the other way round the pairs have depth, so they have hardly "
    "any; "
    "exchange the pictures or cameras, or calibrate them as they are";

}  // namespace kaz::vision
