// Blocks of two rectified pictures compared: for each pixel the disparity of least difference.
// SPDX-License-Identifier: Apache-2.0
//
// The sum of absolute differences over a block is kept up from row to row and from column to
// column, for all disparities of a pixel side by side: that is what the processor's vectors are
// filled with. Winners are taken from these sums for the left picture and for the right one (along
// their diagonals) in one pass. All sums are whole numbers of 16 bits, so vectors or none, the
// result is the same to the bit.
#pragma once

#include <cstdint>
#include <vector>

namespace kaz::vision {

constexpr int kFilterCap = 31;  // largest code of the filtered picture, both ways from its middle
constexpr int kLargestBlock = 21;  // whose sum is at most 21 x 21 x 62, within 16 bits

// The derivative along the row (Sobel's, 3 x 3), cut off at kFilterCap, plus kFilterCap.
struct FilteredPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> code;

  void filter(const std::uint8_t* grey, int w, int h, bool vectors = true);
  const std::uint8_t* row(int v) const {
    return &code[static_cast<std::size_t>(v) * static_cast<std::size_t>(width)];
  }
};

// The right picture as matching reads it: rows from right to left, so that growing disparities are
// side by side, and beyond the picture's left edge as many columns without texture as needed.
struct MirroredPicture {
  int width = 0, height = 0, disparities = 0;
  std::vector<std::uint8_t> code;

  void mirror(const FilteredPicture& picture, int n);
  // Each pixel moved by the plane a u + b v + c of disparity: what lies in that plane then has
  // disparity 0, and blocks of it compare as if it faced the eyes.
  void warp(const FilteredPicture& picture, double a, double b, double c, int n);
  std::size_t pitch() const { return static_cast<std::size_t>(width + disparities); }
  const std::uint8_t* row(int v) const { return &code[static_cast<std::size_t>(v) * pitch()]; }

 private:
  void resize(const FilteredPicture& picture, int n);
};

// One a pixel of the left picture. Loops over each of them become vectors.
struct BlockMatches {
  std::vector<float> disparity;  // of least difference, placed between pixels
  std::vector<std::int16_t> cost;
  // 1 where it is neither the first nor the last disparity, is better than all others but the two
  // beside it, and is found again from right to left.
  std::vector<std::uint8_t> good;
};

struct BlockOptions {
  int block = 15;
  int uniqueness_percent = 10;
  int left_right_px = 1;
  bool vectors = true;  // where the processor has them
};

class BlockMatcher {
 public:
  // Disparities a multiple of 16. No match where `wanted`, one a pixel, is 0, nor in the half block
  // along the picture's edges.
  void match(const FilteredPicture& left, const MirroredPicture& right,
             const std::vector<std::uint8_t>& wanted, const BlockOptions& options,
             BlockMatches& found);

 private:
  std::vector<std::int16_t> columns_, window_, winners_, right_cost_, right_disparity_;
  std::vector<std::uint8_t> zero_;
};

// 1 for each pixel around which the filtered picture's codes, from their middle, sum up to at least
// so much over a block, else 0.
class BlockTexture {
 public:
  void find(const FilteredPicture& picture, int block, int least,
            std::vector<std::uint8_t>& textured);

 private:
  std::vector<std::int32_t> columns_;
};

}  // namespace kaz::vision
