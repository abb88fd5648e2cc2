// Sums over patches and validation of cells of dense flow, row by row. Plain and AVX2 code give equal
// results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::vision {

constexpr int kFlowSmall = 4;  // reduction factor of the finest pictures of the search
// Side of a patch, small pixels; must be odd (the inverse search uses 8).
constexpr int kFlowPatch = 7;
// Variance of the difference of two small pictures, codes^2, if the full pictures have a noise of 2 codes.
constexpr float kFlowNoise2 = 0.5F;

// Products of quantities at each small pixel, and the sums of these products over patches. Quantities:
// gradient (gx, gy), brightness q, change d of the brightness along the flow, weight w. The products, in this
// order:
//   gx gx, gx gy, gy gy, gx d, gy d, d d, d, w, gx, gy, q, q q.
// The weight w is 1 where the flow stays inside the picture. All products are 0 where the flow leaves the
// picture.
class FlowProducts {
 public:
  static constexpr std::size_t kCount = 12;
  using Rows = std::array<const float*, kCount>;

  explicit FlowProducts(bool vectors = true) : vectors_(vectors) {}
  void resize(int width, int height);
  // Computes the products of row y of the earlier small picture from `row` and the rows above and below. Row
  // y must be neither the first nor the last. `there` is the brightness of the later picture along the flow,
  // valid where `compared` is not 0. The first and last pixel count as not compared.
  void set_row(int y, const float* up, const float* row, const float* down, const float* there,
               const float* compared);
  // Returns sums over the patches around the pixels of row y, one row per product, valid until the next call.
  // Pixels beyond the edge have weight 0. Each sum is computed anew, first down the columns, then along the
  // row, because running sums would accumulate rounding errors.
  Rows sum_row(int y);
  // Returns 1 for each pixel of row y that was compared, else 0.
  const float* compared(int y) const { return plane(7) + at(y) + kFlowPatch / 2; }

 private:
  std::size_t at(int y) const { return static_cast<std::size_t>(y + kFlowPatch / 2) * pitch_; }
  const float* plane(std::size_t k) const { return &memory_[k * plane_]; }

  bool vectors_;
  int width_ = 0, height_ = 0;
  std::size_t pitch_ = 0, plane_ = 0;  // numbers per row, per product
  std::vector<float> memory_;          // each product with half a patch of zeros around it
  std::vector<float> columns_, sums_;  // column sums and patch sums of one row
};

// Limits of judge_flow_row().
struct FlowLimits {
  float max_unlike, error2, step2;  // error2, step2: squared limits, small px^2
};
struct FlowCertaintyRow {
  float *xx, *xy, *yy;
};

// Validates the cells of a row and writes their certainty. <x> is the weighted mean of x over the patch of a
// cell. Units: small px and gray codes.
// - Structure tensor G = (xx xy; xy yy), smaller eigenvalue `lesser` = (xx + yy) / 2 - sqrt(((xx - yy) / 2)^2
//   + xy^2).
// - Residual variance s^2 (`unlike`) = <d d> - <d>^2, brightness variance (`varies`) = <q q> - <q>^2.
// - Similarity: s^2 <= max_unlike varies + noise.
// - Standard error: s^2 / (n lesser) <= max_error^2, with n = kFlowPatch^2 and s^2 not below the noise.
// - Further Lucas-Kanade step: |G^-1 b|^2 <= max_step^2, with b = <g d> - <g> <d>.
// The certainty is n G / s^2, in 1/px^2 of the full picture, and 0 where a test fails.
void judge_flow_row(const FlowProducts::Rows& sums, const float* compared, int width,
                    const FlowLimits& limits, const FlowCertaintyRow& to, bool vectors = true);

}  // namespace kaz::vision
