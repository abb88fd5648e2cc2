// Detects swapped pictures of a pair: left and right camera plugged in the wrong way round.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vision/depth/depth.h"

namespace kaz::vision {

// True where the pair gives hardly any depth, and would give a scene's worth with left and right
// exchanged: objects are then further right in the right picture, where no depth is looked for. Pairs
// that cannot be compared at all (DepthFinder's errors) say nothing: false. Twice the work of one
// depth image.
bool cameras_look_swapped(const StereoImages& pair, const FrameInfo& info,
                          const DepthOptions& options = {});

}  // namespace kaz::vision
