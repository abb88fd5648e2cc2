// Warps pictures by a table: each pixel is read from a position of a source picture and multiplied by a gain.
// SPDX-License-Identifier: Apache-2.0
//
// Interpolation is bilinear in 8-bit codes, with fractions of 1/128 pixel. All arithmetic is done with
// integers. Therefore the results are the same on every machine, with or without SIMD instructions.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace kaz::vision {

class Remap {
 public:
  // Source position (px) of a pixel of the result, and gain by which the code is multiplied (0 to 1).
  // Positions more than half a pixel outside the source give black.
  struct Place {
    double u = 0, v = 0, gain = 1;
  };
  struct Size {
    int width = 0, height = 0;
  };
  // The columns `first .. end - 1` of a row; empty if `end <= first`.
  struct Columns {
    int first = 0, end = 0;
  };
  // Calls `place` for each pixel of the result. The source must be at least 2 pixels wide and high.
  Remap(Size size, Size source, const std::function<Place(int u, int v)>& place);

  Size size() const { return size_; }
  Size source() const { return source_; }

  std::vector<Columns> all_rows() const;
  // Returns one range of columns for each row of the source. These columns are needed to compute the columns
  // `wanted` of the result. `wanted` has one entry per row of the result.
  std::vector<Columns> sources(std::span<const Columns> wanted) const;

  // Computes the given columns of row `v` of the result. A pixel has three numbers: red, green and blue. The
  // unit of these numbers is 1/64 of a color code. `out` points to the numbers of column 0. One number after
  // the last column is also overwritten.
  void row(std::span<const std::uint8_t> source_rgb, int v, Columns columns,
           std::uint16_t* out) const;
  // Like row(), but without SIMD. For processors without SIMD and for tests.
  void row_plain(std::span<const std::uint8_t> source_rgb, int v, Columns columns,
                 std::uint16_t* out) const;
  // Computes the whole picture with rounded codes. Resizes `rgb`, which must not be the source.
  void apply(std::span<const std::uint8_t> source_rgb, std::vector<std::uint8_t>& rgb) const;

 private:
  struct Tap {
    // Each pixel of the result is interpolated between four pixels of the source. `offset` is the byte offset
    // of the upper left of these pixels.
    std::uint32_t offset = 0;
    std::uint8_t upper = 128, lower = 0;  // row weights; their sum is 128
    std::uint16_t unused = 0;
    std::uint16_t left = 0, right = 0;  // column weights; their sum is 32768 for gain 1
  };
  const Tap* taps_of(int v) const {
    return taps_.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(size_.width);
  }
  // The row must not use the last pixel of the source, and `columns` must not be empty.
  void row_sse2(const std::uint8_t* source_rgb, int v, Columns columns, std::uint16_t* out) const;
  void row_avx2(const std::uint8_t* source_rgb, int v, Columns columns, std::uint16_t* out) const;

  Size size_, source_;
  std::vector<Tap> taps_;
  // For each row of the result: 1 if the row uses the last pixel of the source. Such a row is computed by
  // row_plain(), because row_sse2() and row_avx2() read a few bytes beyond the pixels that they use.
  std::vector<std::uint8_t> at_end_;
};

}  // namespace kaz::vision
