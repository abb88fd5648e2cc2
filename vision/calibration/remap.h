// Pictures bent by a table: each pixel taken from a place of a source picture, and scaled.
// SPDX-License-Identifier: Apache-2.0
//
// Bilinear in 8-bit codes, with fractions of 1/128 pixel. All sums are of integers: the same bytes on
// every machine, whether by vectors or one by one.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "vision/image/frame.h"

namespace kaz::vision {

class Remap {
 public:
  // Where a pixel's value comes from, px of the source; what its code is multiplied by, 0..1.
  // Places more than half a pixel outside the source are black.
  struct Place {
    double u = 0, v = 0, gain = 1;
  };
  struct Size {
    int width = 0, height = 0;
  };
  // Columns first .. end - 1 of a row; none: end <= first.
  struct Columns {
    int first = 0, end = 0;
  };
  // Sides of the source: at least 2.
  Remap(Size size, Size source, const std::function<Place(int u, int v)>& place);

  Size size() const { return size_; }
  Size source() const { return source_; }

  std::vector<Columns> all_rows() const;
  // By row of the source: the columns that the columns `wanted` of the rows of the result are made of, and
  // those in between.
  std::vector<Columns> sources(std::span<const Columns> wanted) const;

  // Columns of row `v` in 64ths of a code, three numbers each: column 0 at `out`. The number after those of
  // the last column is written too.
  void row(std::span<const std::uint8_t> source_rgb, int v, Columns columns,
           std::uint16_t* out) const;
  // The same without vectors, for other processors and for tests.
  void row_plain(std::span<const std::uint8_t> source_rgb, int v, Columns columns,
                 std::uint16_t* out) const;
  // The whole picture, codes rounded. `rgb` is resized; it must not be the source.
  void apply(std::span<const std::uint8_t> source_rgb, std::vector<std::uint8_t>& rgb) const;

 private:
  struct Tap {
    std::uint32_t offset = 0;             // of the upper left of four pixels, bytes
    std::uint8_t upper = 128, lower = 0;  // weights of the rows: 128 together
    std::uint16_t unused = 0;
    std::uint16_t left = 0, right = 0;  // of the columns: 32768 together where the gain is 1
  };
  const Tap* taps_of(int v) const {
    return taps_.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(size_.width);
  }
  // Rows that do not use the last pixel; one column or more.
  void row_sse2(const std::uint8_t* source_rgb, int v, Columns columns, std::uint16_t* out) const;
  void row_avx2(const std::uint8_t* source_rgb, int v, Columns columns, std::uint16_t* out) const;

  Size size_, source_;
  std::vector<Tap> taps_;
  std::vector<std::uint8_t> at_end_;  // rows that use the last pixel, beyond which nothing is read
};

}  // namespace kaz::vision
