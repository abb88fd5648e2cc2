// Sums over patches and validation of cells of dense flow, row by row, plain and with AVX2; equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::vision {

constexpr int kFlowSmall = 4;  // factor by which the inverse search's finest pictures are smaller
constexpr int kFlowPatch = 7;  // odd, of small pixels; the inverse search's are 8
constexpr float kFlowNoise2 =
    0.5F;  // codes^2, variance of the difference of two small pictures; 2 codes a pixel

// By small pixel, with gradient (gx, gy), brightness q, change d along the flow and weight w:
// gx gx, gx gy, gy gy, gx d, gy d, d d, d, w, gx, gy, q, q q; all 0 where the flow leaves the picture, else
// w is 1.
class FlowProducts {
 public:
  static constexpr std::size_t kCount = 12;
  using Rows = std::array<const float*, kCount>;

  explicit FlowProducts(bool vectors = true) : vectors_(vectors) {}
  void resize(int width, int height);
  // Row y, neither the first nor the last, of the earlier small picture, with the rows above and below;
  // `there`: brightness of the later one along the flow, where `compared` is 1 and not 0. The first and last
  // pixel count as not compared.
  void set_row(int y, const float* up, const float* row, const float* down, const float* there,
               const float* compared);
  // Sums over the patches around the pixels of row y, separably, rows first; pixels beyond the edge have
  // weight 0. No running sums, whose rounding errors would accumulate.
  Rows sum_row(int y);
  // 1 where the pixels of row y were compared.
  const float* compared(int y) const { return plane(7) + at(y) + kFlowPatch / 2; }

 private:
  std::size_t at(int y) const { return static_cast<std::size_t>(y + kFlowPatch / 2) * pitch_; }
  const float* plane(std::size_t k) const { return &memory_[k * plane_]; }

  bool vectors_;
  int width_ = 0, height_ = 0;
  std::size_t pitch_ = 0, plane_ = 0;  // of a row, of a product
  std::vector<float> memory_;          // half a patch of zeros around each product
  std::vector<float> columns_, sums_;  // of a row: sums over its columns, over its patches
};

// Validates the cells of a row by the weighted means over their patches, all of the small pictures (units:
// small px):
//   structure tensor G = (xx xy; xy yy), smaller eigenvalue
//   `lesser` = (xx + yy) / 2 - sqrt(((xx - yy) / 2)^2 + xy^2);
//   residual variance s^2 (`unlike`) = <d d> - <d>^2, brightness variance (`varies`) = <q q> - <q>^2;
//   similarity: s^2 <= max_unlike varies + noise;
//   standard error: s^2 / (n lesser) <= max_error^2, n = kFlowPatch^2;
//   further Lucas-Kanade step: G^-1 b with b = <g d> - <g> <d>, no longer than max_step.
// Certainty: n G / s^2, in 1/px^2 of the full picture; 0 where the flow is not valid.
struct FlowLimits {
  float max_unlike, error2, step2;  // the latter two in small px^2
};
struct FlowCertaintyRow {
  float *xx, *xy, *yy;
};
void judge_flow_row(const FlowProducts::Rows& sums, const float* compared, int width,
                    const FlowLimits& limits, const FlowCertaintyRow& to, bool vectors = true);

}  // namespace kaz::vision
