// Learns the thresholds of a color from a marked region of a picture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "shared/base/result.hpp"
#include "vision/color/color.h"

namespace kaz::vision {

struct PictureRegion {
  int x = 0, y = 0, width = 0, height = 0;  // px, from the upper left pixel
};

struct LearnedColor {
  ColorRange range;
  double inside = 0;   // share of the region's pixels that are in the color range
  double outside = 0;  // share of all other pixels that are in the color range

  // Maximum plausible value of `outside`. If `outside` is above kLargestObject, the thresholds select nearly
  // everything. Only a very near object covers more than a quarter of a picture.
  static constexpr double kLargestObject = 0.25;
  bool too_common() const { return outside > kLargestObject; }
};

// Learns the color of an object from a region that should lie within the object. At least half of the
// region's pixels must have the same hue (within 0.6 rad of the mean direction of chroma). The learned range
// of hue covers 98 % of the pixels with this hue. A margin of 0.06 rad on each side allows for the noise of
// other pictures. The minimum saturation is 0.8 times the second percentile of these pixels' saturations. The
// minimum lightness is 0.5 times the second percentile of their lightness. With the factors 0.8 and 0.5, the
// range includes the shaded side of the object. Error: a gray object, which has no hue.
Result<LearnedColor> learn_color(const Image& image, const PictureRegion& region);

// A picture with a marked region. `name` is for error messages.
struct MarkedPicture {
  std::string name;
  Image image;
  PictureRegion region;
};

// Learns the color from several pictures, for example of other places, cameras or light. The result is the
// smallest range that contains the ranges of all pictures. `inside` and `outside` are means over the
// pictures. Errors: no picture, the error of a picture, or hues that differ by pi or more.
Result<LearnedColor> learn_color(std::span<const MarkedPicture> pictures);

}  // namespace kaz::vision
