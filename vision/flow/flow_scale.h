// From pictures to those of the search, a quarter as wide and high, and from its flow to one a pixel.
// Internal to vision/flow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::vision {

// Means of squares of 4 x 4 pixels, halves rounded to even, as by cv::resize with INTER_AREA. Sides of the
// picture are multiples of 4; rows without padding.
void quarter(const std::uint8_t* grey, int width, int height, std::uint8_t* to);

// Bilinear interpolation of a flow of `small` pixels, (right, down) a pixel, at the centres of the full
// picture's pixels, multiplied by `factor`; as by cv::resize with INTER_LINEAR, bit by bit: first along the
// rows, then down the columns, each as a (1 - s) + b s.
class FlowEnlarger {
 public:
  struct Size {
    int width = 0, height = 0;
    bool operator==(const Size&) const = default;
  };
  void resize(Size small, Size full);
  void enlarge(const float* small, float factor, float* full);

 private:
  struct Tap {
    int at;        // the first of both
    float a0, a1;  // weights
  };
  static std::vector<Tap> taps(int small, int full);
  void enlarge_row(const float* small, float* to) const;

  Size small_, full_;
  std::vector<Tap> across_, down_;
  std::vector<float> rows_;  // of the small flow, as wide as the full picture
};

}  // namespace kaz::vision
