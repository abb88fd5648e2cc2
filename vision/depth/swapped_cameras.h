// Detects swapped left and right pictures, for example from cameras that are plugged in the wrong way round.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vision/depth/depth.h"

namespace kaz::vision {

// Result of eye_order(). The result is `unclear` if DepthFinder returns an error. In darkness, the result is
// `unclear` because hardly any pixel gets a depth. With a repeating pattern, the result is `unclear` because
// the number of pixels with depth is similar for both orders of the pictures.
enum class EyeOrder : std::uint8_t { unclear, as_named, swapped };

// Computes two small depth images: one from the pair as given, and one from the pair with left and right
// exchanged. Compares the numbers of pixels with known depth in these two images. If the pictures are
// swapped, objects are further right in the right picture than in the left picture. Block matching expects
// objects further left in the right picture. Therefore block matching finds the depth of fewer pixels if the
// pictures are swapped.
EyeOrder eye_order(const StereoImages& pair, const FrameInfo& info,
                   const DepthOptions& options = {});

// Decides for a whole run whether the cameras are swapped. Several pairs are used, because the result of a
// single pair may be wrong, and pictures may be disturbed for some time.
class SwappedCameras {
 public:
  static constexpr int kFirst = 5;
  static constexpr Time kInterval = std::chrono::milliseconds(500);

  explicit SwappedCameras(const DepthOptions& options = {}) : options_(options) {}

  // Evaluates the first kFirst pairs. Ignores a later pair if its exposure is less than kInterval after the
  // exposure of the previously evaluated pair.
  void look(const StereoImages& pair, const FrameInfo& info);
  // Returns true if both of these conditions hold:
  // - At least two thirds of the pairs with the result `swapped` or `as_named` have the result `swapped`.
  // - At least three pairs, or at least half of the evaluated pairs, have the result `swapped`.
  bool found() const;

 private:
  DepthOptions options_;
  Time next_{};
  int looked_ = 0, as_named_ = 0, swapped_ = 0;
};

// Message for the user if found() returns true.
inline constexpr const char* kSwappedCameras =
    "left and right seem exchanged, because the pair gives more depth with exchanged pictures: "
    "exchange the pictures or the cameras, or calibrate the cameras again";

}  // namespace kaz::vision
