// Sequential RANSAC (M. A. Fischler, R. C. Bolles, CACM 24(6), 1981) for planes in disparity.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_slants.h"

#include <algorithm>
#include <cmath>

#include "shared/base/random.hpp"

namespace kaz::vision {
namespace {

constexpr int kColumns = 40;  // of the grid of sampled pixels
constexpr int kTrials =
    100;  // finds a plane with a third of the points with 98 %: 1 - (1 - 1/27)^100
constexpr float kBand_px =
    1;  // inlier threshold: fronto-parallel blocks err by about half a pixel on a slant
constexpr float kMinSlant = 0.5F;  // px over a block: less has no effect

}  // namespace

int SlantFinder::count(const DisparityPlane& plane, float band) const {
  int n = 0;
  for (const Point& p : points_) n += std::abs(p.d - plane.at(p.u, p.v)) < band ? 1 : 0;
  return n;
}

bool SlantFinder::refine(DisparityPlane& plane, float band) const {
  PlaneFit fit;
  for (const Point& p : points_) {
    if (std::abs(p.d - plane.at(p.u, p.v)) < band)
      fit.add(static_cast<double>(p.u), static_cast<double>(p.v), static_cast<double>(p.d));
  }
  return fit.solve(plane);
}

const std::vector<DisparityPlane>& SlantFinder::find(const std::vector<float>& disparity, int width,
                                                     int height, int block, int max_planes) {
  planes_.clear();
  points_.clear();
  const int step = std::max(2, width / kColumns);
  for (int v = step / 2; v < height; v += step) {
    for (int u = step / 2; u < width; u += step) {
      const float d = disparity[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                                static_cast<std::size_t>(u)];
      if (d > 0) points_.push_back({static_cast<float>(u), static_cast<float>(v), d});
    }
  }
  const std::size_t sampled = points_.size();
  Random random(1);
  for (int round = 0; round < max_planes && points_.size() * 10 >= sampled && points_.size() > 20;
       ++round) {
    DisparityPlane best;
    int max_on = 0;
    const auto size = static_cast<std::uint32_t>(points_.size());
    for (int trial = 0; trial < kTrials; ++trial) {
      const Point &p = points_[random.below(size)], &q = points_[random.below(size)],
                  &r = points_[random.below(size)];
      // Plane d = a u + b v + c through the three points by Cramer's rule, px.
      const float u1 = q.u - p.u, v1 = q.v - p.v, d1 = q.d - p.d;
      const float u2 = r.u - p.u, v2 = r.v - p.v, d2 = r.d - p.d;
      const float area = u1 * v2 - u2 * v1;
      if (std::abs(area) < static_cast<float>(100 * step)) continue;
      DisparityPlane plane{(d1 * v2 - d2 * v1) / area, (u1 * d2 - u2 * d1) / area, 0};
      plane.c = p.d - plane.a * p.u - plane.b * p.v;
      const int on = count(plane, kBand_px);
      if (on > max_on) {
        max_on = on;
        best = plane;
      }
    }
    // Refined by least squares over the inliers, twice.
    if (static_cast<std::size_t>(10 * max_on) < sampled) break;
    if (!refine(best, kBand_px) || !refine(best, kBand_px)) break;
    const float slant = static_cast<float>(block) * (std::abs(best.a) + std::abs(best.b));
    // Slopes that no real surface has come from a plane through two surfaces.
    if (slant >= kMinSlant && std::abs(best.a) < 0.5F && std::abs(best.b) < 1)
      planes_.push_back(best);
    std::erase_if(points_,
                  [&](const Point& p) { return std::abs(p.d - best.at(p.u, p.v)) < 2 * kBand_px; });
  }
  return planes_;
}

}  // namespace kaz::vision
