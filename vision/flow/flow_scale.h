// Scales pictures down to a quarter for the search, and its flow up to one vector per pixel. Internal to
// vision/flow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::vision {

// Reduces a gray picture to the means of squares of 4 x 4 pixels. Halves round to even, as in cv::resize with
// INTER_AREA. Width and height must be multiples of 4; rows have no padding.
void quarter(const std::uint8_t* grey, int width, int height, std::uint8_t* to);

// Interpolates a flow of small pixels, (right, down) each, bilinearly at the centers of the full picture's
// pixels, and multiplies it by `factor`. Bit-identical to cv::resize with INTER_LINEAR: first along the rows,
// then down the columns, each as a (1 - s) + b s.
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
    int at;        // index of the first of two
    float a0, a1;  // weights
  };
  static std::vector<Tap> taps(int small, int full);
  void enlarge_row(const float* small, float* to) const;

  Size small_, full_;
  std::vector<Tap> across_, down_;
  std::vector<float> rows_;  // rows of the small flow, already as wide as the full picture
};

}  // namespace kaz::vision
