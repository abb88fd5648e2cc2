// Block matching of two rectified images: the disparity of minimum difference per pixel.
// SPDX-License-Identifier: Apache-2.0
//
// Cost: the sum of absolute differences (SAD) over the block, as a running sum over rows and columns, for
// all disparities of a pixel side by side, which fill the SIMD vectors. Winners of the left image and of the
// right one (along the diagonals of the cost volume) are found in one pass, row by row, so that what follows
// finds them in the cache. All sums are 16-bit integers, so the result is bit-identical with and without
// SIMD.
#pragma once

#include <cstdint>
#include <vector>

#include "vision/depth/depth_filter.h"
#include "vision/depth/depth_rows.h"

namespace kaz::vision {

constexpr int kLargestBlock = 21;  // whose sum is at most 21 x 21 x 62, within 16 bits

// Horizontal 3 x 3 Sobel derivative, clamped to +-kFilterCap, plus kFilterCap.
struct FilteredPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> code;  // and kVectorMargin more

  void filter(const std::uint8_t* grey, int w, int h, bool vectors);
  const std::uint8_t* row(int v) const {
    return &code[static_cast<std::size_t>(v) * static_cast<std::size_t>(width)];
  }
};

// The right image as the matcher reads it: rows mirrored, so that increasing disparities are adjacent in
// memory, with columns without texture beyond the left border.
struct MirroredPicture {
  int width = 0, height = 0, disparities = 0;
  std::vector<std::uint8_t> code;

  void mirror(const FilteredPicture& picture, int n, bool vectors);
  // Warps by the plane d = a u + b v + c: points on the plane get disparity 0, so that blocks on it are
  // compared as if it were fronto-parallel.
  void warp(const FilteredPicture& picture, double a, double b, double c, int n, bool vectors);
  std::size_t pitch() const { return static_cast<std::size_t>(width + disparities); }
  const std::uint8_t* row(int v) const { return &code[static_cast<std::size_t>(v) * pitch()]; }

 private:
  void resize(const FilteredPicture& picture, int n);
};

struct BlockOptions {
  int block = 15;
  int uniqueness_percent = 10;
  int left_right_px = 1;
  bool vectors = true;  // where the processor has them
};

class BlockMatcher {
 public:
  // Disparities: a multiple of 16. Both pictures are read by row().
  void begin(const FilteredPicture& left, const MirroredPicture& right,
             const BlockOptions& options);
  // Matches row v where `wanted`, which is read up to kVectorMargin beyond the row, is not 0, but for half a
  // block at both ends of the row. Rows rise, and are half a block or more inside of the picture.
  const MatchedRow& row(int v, const std::uint8_t* wanted);

 private:
  const FilteredPicture* left_ = nullptr;
  const MirroredPicture* right_ = nullptr;
  BlockOptions options_;
  BlockRow sums_{};
  MatchedRow matched_{};
  int first_ = 0, next_ = 0;  // rows of the pictures: first in the sums, and next to enter
  std::vector<std::int16_t> columns_, window_, windows_, winners_, place_;
  std::vector<std::uint32_t> claims_;
  std::vector<std::uint8_t> zero_;
};

// Texture mask: 1 where the sum of absolute derivatives over a block is at least `min_sum`, else 0. With
// kVectorMargin bytes more.
class BlockTexture {
 public:
  void find(const FilteredPicture& picture, int block, int min_sum, bool vectors,
            std::vector<std::uint8_t>& textured);

 private:
  std::vector<std::int16_t> columns_;
  std::vector<std::uint8_t> none_;
};

}  // namespace kaz::vision
