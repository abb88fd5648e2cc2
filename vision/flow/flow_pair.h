// Validation and gray conversion of the two input images of optical flow. Internal to vision/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core.hpp>

#include "vision/depth/depth.h"
#include "vision/image/frame.h"

namespace kaz::vision {

// View of an input image: 8 bits per channel, rows from the top, no padding. Does not own the bytes.
struct ImageView {
  int width, height, channels;
  std::span<const std::uint8_t> bytes;
};

inline ImageView image_view(const Image& image) {
  return {image.width, image.height, 3, image.rgb};
}
inline ImageView image_view(const GreyPicture& picture) {
  return {picture.width, picture.height, 1, picture.pixels};
}

// Minimum side. Smaller images contain no patch at the coarsest level.
inline constexpr int kSmallestFlow_px = 64;

// Checks both images. Errors are those of FlowFinder::find(), except for options.
Result<void> check_flow_pair(const ImageView& before, const FrameInfo& info_before,
                             const ImageView& after, const FrameInfo& info_after);
// Returns `image` as gray: a view of its own pixels if it is gray, else of `memory`, which receives the
// converted pixels.
cv::Mat flow_grey(const ImageView& image, cv::Mat& memory);

}  // namespace kaz::vision
