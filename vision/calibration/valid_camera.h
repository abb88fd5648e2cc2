// Checks a camera model from an external source for plausibility.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "vision/image/frame.h"

namespace kaz::vision {

// Returns whether a camera model from a file, socket or recording is plausible. All numbers of a plausible
// model are finite, and small enough that the results of computations with the model are also finite.
inline bool valid_camera(const CameraModel& c) {
  constexpr int kMaxSide = 16384;
  constexpr double kMaxFocal = 1e6, kMaxBaseline_m = 10;
  const auto focal = [](double f) { return f > 0 && f <= kMaxFocal; };  // false for NaN
  const auto centre = [](double x) { return std::abs(x) <= kMaxFocal; };
  return c.width >= 1 && c.width <= kMaxSide && c.height >= 1 && c.height <= kMaxSide &&
         focal(c.fx) && focal(c.fy) && centre(c.cx) && centre(c.cy) && c.baseline_m >= 0 &&
         c.baseline_m <= kMaxBaseline_m;
}

}  // namespace kaz::vision
