// Thresholds of a colour from a marked region of a picture.
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
  double inside = 0;   // share of the region's pixels that the range lets through
  double outside = 0;  // share of all others: 0 where nothing else has the colour

  // Hardly anything but a near object itself has more of a picture: the thresholds find everything.
  static constexpr double kLargestObject = 0.25;
  bool too_common() const { return outside > kLargestObject; }
};

// The region should lie within the object, or hold little else: at least half of its pixels must be of
// one hue (within 0.6 rad of the chroma's mean direction). Of those, hue spans 98 % and 0.06 rad more
// on each side for the noise of other pictures, minimum saturation is 0.8 and minimum lightness 0.5 of
// what 98 % have, for the shaded side. Grey objects have no hue: an error.
Result<LearnedColor> learn_color(const Image& image, const PictureRegion& region);

}  // namespace kaz::vision
