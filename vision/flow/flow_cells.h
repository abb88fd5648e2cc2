// Computes sums over patches, and uses the sums to validate the cells of dense flow, one row at a time. Plain
// and AVX2 code give equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace kaz::vision {

// Reduction factor from the full pictures to the finest pictures of the search.
constexpr int kFlowSmall = 4;
// Side of a patch, in pixels of the reduced picture; must be odd. The patches of the inverse search have 8 x
// 8 pixels.
constexpr int kFlowPatch = 7;
// Variance (codes^2) that noise causes in the difference between two reduced pictures. The noise of the full
// pictures is assumed to have a standard deviation of 2 codes.
constexpr float kFlowNoise2 = 0.5F;

// Products of quantities at each pixel of the reduced picture, and the sums of these products over patches.
// Quantities: gradient (gx, gy), brightness q, change d of the brightness along the flow, weight w. The order
// of the products is:
//   gx gx, gx gy, gy gy, gx d, gy d, d d, d, w, gx, gy, q, q q.
// The weight w is 1 where the flow stays inside the picture. Where the flow leaves the picture, all products
// are 0.
class FlowProducts {
 public:
  static constexpr std::size_t kCount = 12;
  using Rows = std::array<const float*, kCount>;

  explicit FlowProducts(bool vectors = true) : vectors_(vectors) {}
  void resize(int width, int height);
  // Computes the products of row y of the earlier reduced picture. `row`: this row; `up` and `down`: the rows
  // above and below. Row y must be neither the first nor the last. For each pixel of the row, `there` is the
  // brightness of the later picture at the position to which the flow leads. Where `compared` is 0, the value
  // of `there` is ignored. In each row, the first pixel and the last pixel count as not compared.
  void set_row(int y, const float* up, const float* row, const float* down, const float* there,
               const float* compared);
  // Returns the sums over the patches around the pixels of row y: one row of sums per product. The rows are
  // valid until the next call. Pixels beyond the edge have weight 0. Each sum is computed anew, first down
  // the columns, then along the row, because running sums would accumulate rounding errors.
  Rows sum_row(int y);
  // Returns 1 for each pixel of row y that was compared, else 0.
  const float* compared(int y) const { return plane(7) + at(y) + kFlowPatch / 2; }

 private:
  std::size_t at(int y) const { return static_cast<std::size_t>(y + kFlowPatch / 2) * pitch_; }
  const float* plane(std::size_t k) const { return &memory_[k * plane_]; }

  bool vectors_;
  int width_ = 0, height_ = 0;
  std::size_t pitch_ = 0, plane_ = 0;  // number of floats per row, and per product
  // All products. A border of zeros surrounds the values of each product. The border is half a patch wide.
  std::vector<float> memory_;
  std::vector<float> columns_, sums_;  // column sums and patch sums of one row
};

// Limits of judge_flow_row().
struct FlowLimits {
  // The members error2 and step2 are the squares of FlowOptions::max_error_px and max_step_px, converted to
  // px^2 of the reduced picture.
  float max_unlike, error2, step2;
};
struct FlowCertaintyRow {
  float *xx, *xy, *yy;
};

// Validates the cells of a row and writes the certainty of each cell. Here mean(x) is the weighted mean of x
// over the patch of a cell. Units: px of the reduced picture, and gray codes.
// - Structure tensor G = (xx xy; xy yy). The smaller eigenvalue of G is
//   `lesser = (xx + yy) / 2 - sqrt(((xx - yy) / 2)^2 + xy^2)`.
// - Residual variance (`unlike`): s^2 = mean(d d) - mean(d)^2.
// - Brightness variance (`varies`): mean(q q) - mean(q)^2.
// - Test of the similarity: `s^2 <= max_unlike * varies + noise`.
// - Test of the standard error: `s^2 / (n * lesser) <= max_error^2`. Here n is kFlowPatch^2, and s^2 is at
//   least the noise.
// - Test of the patch: at least half of the patch's pixels were compared.
// - Test of a further Lucas-Kanade step: `|G^-1 b|^2 <= max_step^2`. Here b is mean(g d) - mean(g) mean(d),
//   and g is the gradient (gx, gy).
// The certainty is n G / s^2, converted to 1/px^2 of the full picture. Where a test fails, the certainty is
// 0.
void judge_flow_row(const FlowProducts::Rows& sums, const float* compared, int width,
                    const FlowLimits& limits, const FlowCertaintyRow& to, bool vectors = true);

}  // namespace kaz::vision
