// Block matching of two rectified images. Finds, for each pixel, the disparity with the smallest difference.
// SPDX-License-Identifier: Apache-2.0
//
// The cost is the sum of absolute differences (SAD) over the block, computed as a running sum over rows and
// columns. The sums for all disparities of a pixel are adjacent in memory, so that a SIMD vector processes
// many disparities at once. One pass finds the winners (disparities of lowest cost) of both images. The
// winners of the right image are found along the diagonals of the cost volume. The pass goes row by row, so
// that the winners are still in the cache for later steps. All sums are 16-bit integers, so results are
// bit-identical with and without SIMD.
#pragma once

#include <cstdint>
#include <vector>

#include "vision/depth/depth_filter.h"
#include "vision/depth/depth_rows.h"

namespace kaz::vision {

// Maximum side of a block. The sum over such a block is at most 21 x 21 x 62, which fits 16 bits.
constexpr int kLargestBlock = 21;

// A picture filtered by the horizontal 3 x 3 Sobel derivative. A code is the derivative, clamped to
// +-kFilterCap, plus kFilterCap.
struct FilteredPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> code;  // one code per pixel, then kVectorMargin unused bytes

  void filter(const std::uint8_t* grey, int w, int h, bool vectors);
  const std::uint8_t* row(int v) const {
    return &code[static_cast<std::size_t>(v) * static_cast<std::size_t>(width)];
  }
};

// The right image in the form that the matcher reads. Rows are mirrored, so that increasing disparities are
// adjacent in memory. Each row ends with additional columns for the pixels beyond the left border. The
// additional columns have no texture.
struct MirroredPicture {
  int width = 0, height = 0, disparities = 0;
  std::vector<std::uint8_t> code;

  void mirror(const FilteredPicture& picture, int n, bool vectors);
  // Warps the picture by the plane d = a u + b v + c. Points on the plane get disparity 0, so that blocks on
  // the plane are compared as fronto-parallel blocks.
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
  bool vectors = true;  // use SIMD where available
};

class BlockMatcher {
 public:
  // Starts the matching of two pictures. `right.disparities` must be a multiple of 16. Both pictures must
  // outlive the last call of row().
  void begin(const FilteredPicture& left, const MirroredPicture& right,
             const BlockOptions& options);
  // Matches the pixels of row v where `wanted` is not 0. Pixels within half a block of the ends of the row
  // are not matched. After the end of the row, `wanted` must have kVectorMargin more readable bytes.
  // Successive calls must have increasing v. Row v must be at least half a block from the upper and lower
  // border.
  const MatchedRow& row(int v, const std::uint8_t* wanted);

 private:
  const FilteredPicture* left_ = nullptr;
  const MirroredPicture* right_ = nullptr;
  BlockOptions options_;
  BlockRow sums_{};
  MatchedRow matched_{};
  // `first_` is the number of the first row that was added to the running sums. `next_` is the number of the
  // row that is added next.
  int first_ = 0, next_ = 0;
  std::vector<std::int16_t> columns_, window_, windows_, winners_, place_;
  std::vector<std::uint32_t> claims_;
  std::vector<std::uint8_t> zero_;
};

// Computes a texture mask: 1 where the sum of absolute derivatives over a block is at least `min_sum`, and 0
// elsewhere. The mask is kVectorMargin bytes longer than the picture.
class BlockTexture {
 public:
  void find(const FilteredPicture& picture, int block, int min_sum, bool vectors,
            std::vector<std::uint8_t>& textured);

 private:
  std::vector<std::int16_t> columns_;
  std::vector<std::uint8_t> none_;
};

}  // namespace kaz::vision
