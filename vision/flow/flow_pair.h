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

// Minimum side of an image. In a smaller image, no patch fits into the coarsest pyramid level.
inline constexpr int kSmallestFlow_px = 64;

// Checks both images. Returns the errors of FlowFinder::find(), except errors about options.
Result<void> check_flow_pair(const ImageView& before, const FrameInfo& info_before,
                             const ImageView& after, const FrameInfo& info_after);
// Returns `image` as a gray picture. If `image` is gray, the result refers to the pixels of `image`. If
// `image` is in color, the converted pixels are written to `memory`, and the result refers to `memory`.
cv::Mat flow_grey(const ImageView& image, cv::Mat& memory);

}  // namespace kaz::vision
