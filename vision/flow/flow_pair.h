// Validation and grey conversion of the two input images of optical flow. Internal to vision/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core.hpp>

#include "vision/depth/depth.h"
#include "vision/image/frame.h"

namespace kaz::vision {

// An input image: 8 bits per channel, rows from the top.
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

inline constexpr int kSmallestFlow_px =
    64;  // smaller images contain no patch at the coarsest level

// Returns the errors listed at FlowFinder::find().
Result<void> check_flow_pair(const ImageView& before, const FrameInfo& info_before,
                             const ImageView& after, const FrameInfo& info_after);
// Grey of `image`: a view of its pixels if it is grey, else converted into `memory`.
cv::Mat flow_grey(const ImageView& image, cv::Mat& memory);

}  // namespace kaz::vision
