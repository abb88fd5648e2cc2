// Two pictures of one eye as flow needs them: checked, and grey. Inside of vision/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core.hpp>

#include "vision/depth/depth.h"
#include "vision/image/frame.h"

namespace kaz::vision {

// A picture as it was given: so many channels of 8 bits, rows from the top.
struct FlowInput {
  int width, height, channels;
  std::span<const std::uint8_t> bytes;
};

inline FlowInput flow_input(const Image& image) {
  return {image.width, image.height, 3, image.rgb};
}
inline FlowInput flow_input(const GreyPicture& picture) {
  return {picture.width, picture.height, 1, picture.pixels};
}

inline constexpr int kSmallestFlow_px = 64;  // fewer hold no patch of the small pictures

// The errors that FlowFinder::find() names.
Result<void> check_flow_pair(const FlowInput& before, const FrameInfo& info_before,
                             const FlowInput& after, const FrameInfo& info_after);
// Grey of `sight`: a view of its pixels where they are grey, else converted into `memory`.
cv::Mat flow_grey(const FlowInput& sight, cv::Mat& memory);

}  // namespace kaz::vision
