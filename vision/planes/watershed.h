// Marker-controlled watershed of a color picture between two markers. Internal to vision/planes.
// SPDX-License-Identifier: Apache-2.0
//
// Flooding by a priority queue (F. Meyer, "Color image segmentation", IPA 1992). The color difference of two
// pixels is the largest difference of the three channels. Undecided pixels beside a marker wait in one FIFO
// queue per color difference. A pixel from a queue gets the marker of its neighbors. If the neighbors have
// different markers, the pixel becomes part of the line. The order of neighbors is the same as in OpenCV's
// cv::watershed, so every pixel of the result is also the same. A test compares the results of both
// implementations. The outermost pixels of the picture also belong to the line.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vision/planes/bit_image.h"

namespace kaz::vision {

class Watershed {
 public:
  static constexpr std::uint8_t kFirst = 1, kSecond = 2, kLine = 8;  // label 0: enclosed by lines

  // Returns one label per pixel, valid until the next call. `first` and `second` are disjoint markers of one
  // size. `rgb` is a picture of the same size as the markers, rows without padding.
  const std::vector<std::uint8_t>& grow(const std::uint8_t* rgb, const BitImage& first,
                                        const BitImage& second);

 private:
  void set_markers(const BitImage& first, const BitImage& second);
  void queue_beside_markers(const std::uint8_t* rgb, const BitImage& first, const BitImage& second);
  void push(int level, int pixel);
  void flood(const std::uint8_t* rgb);

  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> label_;
  // By pixel: the next pixel in the same queue, or -1 for the last pixel. A pixel is queued only once.
  std::vector<std::int32_t> next_;
  // Queues by color difference; head -1: empty queue.
  std::array<std::int32_t, 256> head_{}, tail_{};
};

}  // namespace kaz::vision
