// Photometric comparison of two flows, and refinement of a region's flow by Gauss-Newton.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/motion_images.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace kaz::vision {

namespace {

[[gnu::always_inline]] inline void grey_of_rgb(const std::uint8_t* __restrict rgb,
                                               std::size_t pixels, float* __restrict to) {
  for (std::size_t i = 0; i < pixels; ++i)
    to[i] = static_cast<float>(rgb[3 * i] + 2 * rgb[3 * i + 1] + rgb[3 * i + 2]) * 0.25F;
}
#if defined(__x86_64__) && defined(__GNUC__)
#define KAZ_X86
[[gnu::target("avx2")]] void grey_of_rgb_avx2(const std::uint8_t* rgb, std::size_t pixels,
                                              float* to) {
  grey_of_rgb(rgb, pixels, to);
}
#endif

}  // namespace

void grey_codes(std::span<const std::uint8_t> bytes, int channels, std::vector<float>& codes) {
  codes.resize(bytes.size() / static_cast<std::size_t>(channels));
  if (channels == 1) {
    std::copy(bytes.begin(), bytes.end(), codes.begin());
    return;
  }
#ifdef KAZ_X86
  if (__builtin_cpu_supports("avx2") != 0)
    return grey_of_rgb_avx2(bytes.data(), codes.size(), codes.data());
#endif
  grey_of_rgb(bytes.data(), codes.size(), codes.data());
}

double misfit(const GreyReader& before, const GreyReader& after, int u, int v, int reach,
              const Eigen::Vector2d& flow_px) {
  const int left = std::max(u - reach, 0), right = std::min(u + reach, before.width - 1);
  const int top = std::max(v - reach, 0), bottom = std::min(v + reach, before.height - 1);
  if (!after.holds(left + flow_px.x(), top + flow_px.y()) ||
      !after.holds(right + flow_px.x(), bottom + flow_px.y()))
    return std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const double d =
          after.between(x + flow_px.x(), y + flow_px.y()) - static_cast<double>(before.at(x, y));
      sum += d * d;
    }
  }
  return sum / ((right - left + 1) * (bottom - top + 1));
}

// One displacement f for all cells, by Gauss-Newton with iterative reweighting: minimises the sum over the
// pixels p of rho(d), d = after(p + f) - before(p), with Geman and McClure's M-estimator, whose weights are
// w = (c^2 / (c^2 + d^2))^2, c = 12 codes. Step: f -= H^-1 b, H = sum w g g^T, b = sum w d g, with the
// gradient g of `after` at p + f by central differences.
bool refine_flow(const GreyReader& before, const GreyReader& after,
                 std::span<const Eigen::Vector2i> corners, int side, Eigen::Vector2d& flow_px) {
  constexpr int kSteps = 12;
  constexpr double kFits2 = 12 * 12, kFurthest_px = 3, kEnd_px = 0.01;
  Eigen::Vector2d f = flow_px;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix2d h = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2i& corner : corners) {
      for (int v = corner.y(); v < std::min(corner.y() + side, before.height); ++v) {
        for (int u = corner.x(); u < std::min(corner.x() + side, before.width); ++u) {
          const double x = u + f.x(), y = v + f.y();
          if (!after.holds(x - 1, y - 1) || !after.holds(x + 1, y + 1)) continue;
          const Eigen::Vector2d g((after.between(x + 1, y) - after.between(x - 1, y)) / 2,
                                  (after.between(x, y + 1) - after.between(x, y - 1)) / 2);
          const double d = after.between(x, y) - static_cast<double>(before.at(u, v));
          const double w = std::pow(kFits2 / (kFits2 + d * d), 2);
          h += w * g * g.transpose();
          b += w * d * g;
        }
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(h);
    if (!(eigen.eigenvalues().x() > 100)) return false;  // 0.2 px from noise of 2 codes
    const Eigen::Vector2d update = -h.inverse() * b;
    f += update;
    if (!((f - flow_px).norm() < kFurthest_px)) return false;
    if (update.norm() < kEnd_px) break;
  }
  flow_px = f;
  return true;
}

// Weighted centroid, px of the earlier picture, of the pixels that move with the flow f and not with the
// static scene's flow r. Two hypotheses for pixel p: moving, d = after(p + f) - before(p); static, the larger
// of after(p + r) - before(p) and, for the pixel that p would cover, after(p + f) - before(p + f - r).
// Weight: min(static^2 - moving^2, 30^2) - 8^2, if positive.
bool moved_middle(const GreyReader& before, const GreyReader& after, int left, int top, int right,
                  int bottom, const Eigen::Vector2d& flow_px, const Eigen::Vector2d& rest_px,
                  Eigen::Vector2d& middle) {
  constexpr double kMin = 8 * 8,
                   kMax = 30 * 30;  // codes^2; the maximum limits the weight of a highlight
  const auto square = [](double d) { return d * d; };
  Eigen::Vector2d sum(0, 0);
  double weight = 0;
  for (int v = std::max(top, 0); v <= std::min(bottom, before.height - 1); ++v) {
    for (int u = std::max(left, 0); u <= std::min(right, before.width - 1); ++u) {
      const Eigen::Vector2d p(u, v), stays = p + rest_px, goes = p + flow_px;
      const Eigen::Vector2d under = goes - rest_px;  // static point that it would cover
      if (!after.holds(stays.x(), stays.y()) || !after.holds(goes.x(), goes.y()) ||
          !before.holds(under.x(), under.y()))
        continue;
      const auto here = static_cast<double>(before.at(u, v));
      const double there = after.between(goes.x(), goes.y());
      const double rests = std::max(square(after.between(stays.x(), stays.y()) - here),
                                    square(there - before.between(under.x(), under.y())));
      const double w = std::min(rests - square(there - here), kMax) - kMin;
      if (w <= 0) continue;
      sum += w * p;
      weight += w;
    }
  }
  if (!(weight > 0)) return false;
  middle = sum / weight;
  return true;
}

}  // namespace kaz::vision
