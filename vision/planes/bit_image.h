// Binary images with one bit per pixel. Operations process 64 pixels at a time. Internal to vision/planes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::vision {

// A binary image, rows from the top. Pixel u of a row is bit u % 64 of word u / 64; bits beyond the row are
// 0.
class BitImage {
 public:
  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t words() const { return words_; }  // words per row
  std::uint64_t* row(int v) { return &bits_[static_cast<std::size_t>(v) * words_]; }
  const std::uint64_t* row(int v) const { return &bits_[static_cast<std::size_t>(v) * words_]; }

  // Reads one byte per pixel, 0 or 1; rows without padding.
  void pack(const std::uint8_t* bytes, int width, int height);
  // Dilate or erode the image with a square whose side is 2 reach + 1 px. `reach` is at most 64. Pixels
  // outside the image have no effect.
  void dilate(int reach);
  void erode(int reach);
  void invert();
  // join() adds the pixels of `other`, remove() removes the pixels of `other`. Both images must have the same
  // size.
  void join(const BitImage& other);
  void remove(const BitImage& other);

 private:
  void dilate_rows(int reach);
  void dilate_columns(int reach);

  int width_ = 0, height_ = 0;
  std::size_t words_ = 0;
  std::vector<std::uint64_t> bits_, rows_;
};

}  // namespace kaz::vision
