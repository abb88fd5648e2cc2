// Detects swapped left and right pictures, for example from cameras that are plugged in the wrong way round.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vision/depth/depth.h"

namespace kaz::vision {

// Result of eye_order(). The result is `unclear` if both orders of the pictures give hardly any depth, as in
// darkness, or if DepthFinder returns an error. The result is also `unclear` if both orders give similar
// amounts of depth, as with a repeating pattern.
enum class EyeOrder : std::uint8_t { unclear, as_named, swapped };

// Compares the depth of the pair with the depth of the exchanged pair. If the pictures are swapped, objects
// are further right in the right picture than in the left picture. Block matching expects objects
// further left in the right picture, and therefore finds less depth in swapped pictures. Computes two small
// depth images.
EyeOrder eye_order(const StereoImages& pair, const FrameInfo& info,
                   const DepthOptions& options = {});

// Decides for a whole run whether the cameras are swapped. Several pairs are used, because the result of a
// single pair may be wrong, and pictures may be disturbed for some time.
class SwappedCameras {
 public:
  static constexpr int kFirst = 5;
  static constexpr Time kInterval = std::chrono::milliseconds(500);

  explicit SwappedCameras(const DepthOptions& options = {}) : options_(options) {}

  // Evaluates the first kFirst pairs, then one pair per kInterval of exposure time. Other pairs are ignored.
  void look(const StereoImages& pair, const FrameInfo& info);
  // Returns true if at least two thirds of the clear pairs are swapped. In addition, the number of swapped
  // pairs must be at least three, or at least half of the number of evaluated pairs.
  bool found() const;

 private:
  DepthOptions options_;
  Time next_{};
  int looked_ = 0, as_named_ = 0, swapped_ = 0;
};

// Message for the user if found() returns true.
inline constexpr const char* kSwappedCameras =
    "left and right look exchanged, because only exchanged pictures give depth: exchange the "
    "pictures or the cameras, or calibrate the cameras again";

}  // namespace kaz::vision
