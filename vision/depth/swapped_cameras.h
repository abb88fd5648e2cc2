// Detects swapped left and right pictures, as of cameras that are plugged in the wrong way round.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vision/depth/depth.h"

namespace kaz::vision {

// `unclear`: both orders give hardly any or similar depth (darkness, a repeating pattern), or the pair cannot
// be compared (errors of DepthFinder).
enum class EyeOrder : std::uint8_t { unclear, as_named, swapped };

// Compares the depth of a pair as it is with that of the exchanged pair. In swapped pictures objects are
// further right in the right one, where no depth is searched. Costs twice one small depth image.
EyeOrder eye_order(const StereoImages& pair, const FrameInfo& info,
                   const DepthOptions& options = {});

// Verdict on a whole run. A single pair may be judged wrongly, and pictures may be disturbed for a while.
class SwappedCameras {
 public:
  static constexpr int kFirst = 5;
  static constexpr Time kInterval = std::chrono::milliseconds(500);

  explicit SwappedCameras(const DepthOptions& options = {}) : options_(options) {}

  // Evaluates the first kFirst pairs, then one per kInterval of exposure time. Returns at once for others.
  void look(const StereoImages& pair, const FrameInfo& info);
  // Returns true if at least two thirds of the clear pairs are swapped. Fewer than three swapped pairs count
  // only if they are half of all evaluated pairs.
  bool found() const;

 private:
  DepthOptions options_;
  Time next_{};
  int looked_ = 0, as_named_ = 0, swapped_ = 0;
};

// Message for the user if found().
inline constexpr const char* kSwappedCameras =
    "left and right look exchanged: the pairs have depth only the other way round; exchange the "
    "pictures or cameras, or calibrate them as they are";

}  // namespace kaz::vision
