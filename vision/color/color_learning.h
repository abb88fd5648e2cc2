// Learns the thresholds of a color from a marked region of a picture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "vision/color/color.h"

namespace kaz::vision {

struct PictureRegion {
  int x = 0, y = 0, width = 0, height = 0;  // px, from the upper left pixel
};

struct LearnedColor {
  ColorRange range;
  double inside = 0;   // share of the region's pixels that are in the range
  double outside = 0;  // share of all other pixels; 0 if nothing else has the color

  // Hardly any object covers a larger share of a picture, unless it is near. Above it, the thresholds select
  // everything.
  static constexpr double kLargestObject = 0.25;
  bool too_common() const { return outside > kLargestObject; }
};

// Learns from a region that should lie within the object. At least half of its pixels must have one hue
// (within 0.6 rad of the mean direction of chroma). The hue range covers 98 % of these, plus 0.06 rad on each
// side for the noise of other pictures. 98 % of them exceed some saturation and lightness. The minimum is 0.8
// of this saturation and 0.5 of this lightness, for the shaded side. Gray objects have no hue, which is an
// error.
Result<LearnedColor> learn_color(const Image& image, const PictureRegion& region);

}  // namespace kaz::vision
