// Reduces pictures to a quarter of their width and height for the flow search. Enlarges the found flow to one
// vector per pixel. Internal to vision/flow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::vision {

// Reduces a gray picture: each result pixel is the mean of a square of 4 x 4 pixels. A mean halfway between
// two codes is rounded to the even code, as cv::resize does with INTER_AREA. Width and height must be
// multiples of 4. Rows have no padding.
void quarter(const std::uint8_t* grey, int width, int height, std::uint8_t* to);

// Enlarges the flow of a small picture, stored as (right, down) per pixel. The flow is interpolated
// bilinearly at the pixel centers of the full picture and multiplied by `factor`. The result is bit-identical
// to cv::resize with INTER_LINEAR. Values are interpolated first along the rows, then down the columns, each
// time by the formula `a * (1 - s) + b * s`.
class FlowEnlarger {
 public:
  struct Size {
    int width = 0, height = 0;
    bool operator==(const Size&) const = default;
  };
  void resize(Size small, Size full);
  void enlarge(const float* small, float factor, float* full);

 private:
  // One interpolated value is `a0 * v[at] + a1 * v[at + 1]`, where v is a row or a column of the small flow.
  struct Tap {
    int at;
    float a0, a1;
  };
  static std::vector<Tap> taps(int small, int full);
  void enlarge_row(const float* small, float* to) const;

  Size small_, full_;
  std::vector<Tap> across_, down_;
  // Rows of the small flow, interpolated to the width of the full picture.
  std::vector<float> rows_;
};

}  // namespace kaz::vision
