// Block matching of two rectified images: the disparity of minimum difference per pixel.
// SPDX-License-Identifier: Apache-2.0
//
// Cost: the sum of absolute differences (SAD) over the block, as a running sum over rows and columns, for
// all disparities of a pixel side by side, which fill the SIMD vectors. Winners of the left image and of the
// right one (along the diagonals of the cost volume) are found in one pass. All sums are 16-bit integers, so
// the result is bit-identical with and without SIMD.
#pragma once

#include <cstdint>
#include <vector>

namespace kaz::vision {

constexpr int kFilterCap = 31;     // codes of the filtered image: 0..2 kFilterCap
constexpr int kLargestBlock = 21;  // whose sum is at most 21 x 21 x 62, within 16 bits

// Horizontal 3 x 3 Sobel derivative, clamped to +-kFilterCap, plus kFilterCap.
struct FilteredPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> code;

  void filter(const std::uint8_t* grey, int w, int h, bool vectors = true);
  const std::uint8_t* row(int v) const {
    return &code[static_cast<std::size_t>(v) * static_cast<std::size_t>(width)];
  }
};

// The right image as the matcher reads it: rows mirrored, so that increasing disparities are adjacent in
// memory, with columns without texture beyond the left border.
struct MirroredPicture {
  int width = 0, height = 0, disparities = 0;
  std::vector<std::uint8_t> code;

  void mirror(const FilteredPicture& picture, int n);
  // Warps by the plane d = a u + b v + c: points on the plane get disparity 0, so that blocks on it are
  // compared as if it were fronto-parallel.
  void warp(const FilteredPicture& picture, double a, double b, double c, int n);
  std::size_t pitch() const { return static_cast<std::size_t>(width + disparities); }
  const std::uint8_t* row(int v) const { return &code[static_cast<std::size_t>(v) * pitch()]; }

 private:
  void resize(const FilteredPicture& picture, int n);
};

// One a pixel of the left picture. Loops over each of them become vectors.
struct BlockMatches {
  std::vector<float> disparity;  // of minimum cost, px, with subpixel interpolation
  std::vector<std::int16_t> cost;
  // 1 where the minimum is not at either end of the range, is unique (uniqueness_percent) except for its
  // two neighbours, and passes the left-right check.
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
  // Disparities: a multiple of 16. No match where `wanted` (one per pixel) is 0, nor within half a block of
  // the image border.
  void match(const FilteredPicture& left, const MirroredPicture& right,
             const std::vector<std::uint8_t>& wanted, const BlockOptions& options,
             BlockMatches& found);

 private:
  std::vector<std::int16_t> columns_, window_, winners_, right_cost_, right_disparity_;
  std::vector<std::uint8_t> zero_;
};

// Texture mask: 1 where the sum of absolute derivatives over a block is at least `min_sum`, else 0.
class BlockTexture {
 public:
  void find(const FilteredPicture& picture, int block, int min_sum,
            std::vector<std::uint8_t>& textured);

 private:
  std::vector<std::int32_t> columns_;
};

}  // namespace kaz::vision
