// Color extraction: selects the pixels of a given hue, independent of the brightness.
// SPDX-License-Identifier: Apache-2.0
//
// Source: paper, section 2.2: "RGB values of a simulated view image are converted to YIQ values to extract
// red". YIQ follows the FCC's NTSC standard of 1953, on 8-bit components 0 to 255.
//   Y = 0.299 R + 0.587 G + 0.114 B            lightness, 0 to 255.
//   I = 0.596 R - 0.274 G - 0.322 B            orange against blue, -152 to 152.
//   Q = 0.211 R - 0.523 G + 0.312 B            purple against green, -133 to 133.
// If a surface is darker, Y, I and Q decrease by the same factor. The hue atan2(Q, I) and the saturation
// hypot(I, Q) / Y do not change. Bounds on hue and saturation therefore also select the shaded side of a
// ball.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "vision/image/frame.h"
#include "vision/image/regions.h"  // Mask

namespace kaz::vision {

struct Yiq {
  double y = 0, i = 0, q = 0;
};
Yiq yiq_from_rgb(double r, double g, double b);

// Bounds of a color. A pixel is selected if its color meets all bounds. The default bounds select every
// pixel.
struct ColorRange {
  double y_min = 0, y_max = 255;
  double i_min = -153, i_max = 153;
  double q_min = -134, q_max = 134;
  // Range of hue, a wedge in the IQ plane, rad; hue_min < hue_max < hue_min + pi. If hue_min and hue_max are
  // both 0, hue is not checked.
  double hue_min = 0, hue_max = 0;
  // Lower bound of the saturation. The saturation is the ratio chroma / lightness: the saturation of gray is
  // 0, and the saturation of pure red is 2.1. If hue_min and hue_max are both 0, saturation_min is ignored.
  // Chroma is the component of (I, Q) along the middle of the wedge. At the sides of the wedge, chroma is
  // hypot(I, Q) multiplied by the cosine of half the wedge's width.
  double saturation_min = 0;

  // Returns the range of the red ball. The hue of pure red is 19.5 degrees, and the range contains hues from
  // 5.5 to 33.5 degrees. The range excludes pale colors and nearly black colors.
  static ColorRange red_ball();
};

// A ColorRange in the form of up to ten half-spaces of RGB with integer coefficients. A pixel is selected if
// r R + g G + b B >= threshold for every half-space. Coefficients are rounded to 1/128 and the threshold to
// an integer. So 16-bit arithmetic never overflows, and every machine extracts the same mask.
class ColorExtractor {
 public:
  struct HalfSpace {
    std::int16_t r, g, b, least;
  };

  explicit ColorExtractor(const ColorRange& range);

  // Writes the mask of an image; an empty image gives an empty mask. Reuses the memory of `mask`.
  void extract(const Image& image, Mask& mask) const;
  // Like extract() above. If `vectors` is false, the CPU's wide vectors are not used. A test compares the
  // masks with and without vectors.
  void extract(const Image& image, Mask& mask, bool vectors) const;
  bool contains(std::uint8_t r, std::uint8_t g, std::uint8_t b) const;
  std::span<const HalfSpace> half_spaces() const { return {half_spaces_.data(), count_}; }

 private:
  std::array<HalfSpace, 10> half_spaces_{};
  std::size_t count_ = 0;
};

}  // namespace kaz::vision
