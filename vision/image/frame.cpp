// SPDX-License-Identifier: Apache-2.0
#include "vision/image/frame.h"

#include <memory>
#include <utility>

namespace kaz::vision {

StereoPair stereo_pair(FrameInfo info, StereoImages images) {
  std::promise<std::shared_ptr<const StereoImages>> pixels;
  pixels.set_value(std::make_shared<const StereoImages>(std::move(images)));
  return {std::move(info), pixels.get_future().share()};
}

}  // namespace kaz::vision
