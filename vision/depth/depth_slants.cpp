// Sequential RANSAC (M. A. Fischler, R. C. Bolles, CACM 24(6), 1981) for planes in disparity.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_slants.h"

#include <algorithm>
#include <cmath>

#include "shared/base/random.hpp"
#include "vision/depth/depth_avx2.h"

namespace kaz::vision {
namespace {

constexpr int kColumns = 40;  // of the grid of sampled pixels
constexpr int kTrials =
    100;  // finds a plane with a third of the points with 98 %: 1 - (1 - 1/27)^100
constexpr float kBand_px =
    1;  // inlier threshold: fronto-parallel blocks err by about half a pixel on a slant
constexpr float kMinSlant = 0.5F;  // px over a block: less has no effect

[[gnu::always_inline]] inline int count_near(const DisparityPlane& plane, const float* u,
                                             const float* v, const float* d, int size, float band) {
  int n = 0;
  for (int i = 0; i < size; ++i) n += std::abs(d[i] - plane.at(u[i], v[i])) < band ? 1 : 0;
  return n;
}
#ifdef KAZ_DEPTH_AVX2
KAZ_AVX2 int count_near_avx2(const DisparityPlane& plane, const float* u, const float* v,
                             const float* d, int size, float band) {
  return count_near(plane, u, v, d, size, band);
}
#endif

}  // namespace

int SlantFinder::count(const DisparityPlane& plane, float band, bool vectors) const {
  const int size = static_cast<int>(d_.size());
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2())
    return count_near_avx2(plane, u_.data(), v_.data(), d_.data(), size, band);
#endif
  (void)vectors;
  return count_near(plane, u_.data(), v_.data(), d_.data(), size, band);
}

bool SlantFinder::refine(DisparityPlane& plane, float band) const {
  PlaneFit fit;
  for (std::size_t i = 0; i < d_.size(); ++i) {
    if (std::abs(d_[i] - plane.at(u_[i], v_[i])) < band)
      fit.add(static_cast<double>(u_[i]), static_cast<double>(v_[i]), static_cast<double>(d_[i]));
  }
  return fit.solve(plane);
}

void SlantFinder::erase(const DisparityPlane& plane, float band) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < d_.size(); ++i) {
    if (std::abs(d_[i] - plane.at(u_[i], v_[i])) < band) continue;
    u_[kept] = u_[i];
    v_[kept] = v_[i];
    d_[kept++] = d_[i];
  }
  for (std::vector<float>* x : {&u_, &v_, &d_}) x->resize(kept);
}

const std::vector<DisparityPlane>& SlantFinder::find(const std::vector<float>& disparity, int width,
                                                     int height, int block, int max_planes,
                                                     bool vectors) {
  planes_.clear();
  for (std::vector<float>* x : {&u_, &v_, &d_}) x->clear();
  const int step = std::max(2, width / kColumns);
  for (int v = step / 2; v < height; v += step) {
    for (int u = step / 2; u < width; u += step) {
      const float d = disparity[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                                static_cast<std::size_t>(u)];
      if (!(d > 0)) continue;
      u_.push_back(static_cast<float>(u));
      v_.push_back(static_cast<float>(v));
      d_.push_back(d);
    }
  }
  const std::size_t sampled = d_.size();
  Random random(1);
  for (int round = 0; round < max_planes && d_.size() * 10 >= sampled && d_.size() > 20; ++round) {
    DisparityPlane best;
    int max_on = 0;
    const auto size = static_cast<std::uint32_t>(d_.size());
    for (int trial = 0; trial < kTrials; ++trial) {
      const std::size_t p = random.below(size), q = random.below(size), r = random.below(size);
      // Plane d = a u + b v + c through the three points by Cramer's rule, px.
      const float u1 = u_[q] - u_[p], v1 = v_[q] - v_[p], d1 = d_[q] - d_[p];
      const float u2 = u_[r] - u_[p], v2 = v_[r] - v_[p], d2 = d_[r] - d_[p];
      const float area = u1 * v2 - u2 * v1;
      if (std::abs(area) < static_cast<float>(100 * step)) continue;
      DisparityPlane plane{(d1 * v2 - d2 * v1) / area, (u1 * d2 - u2 * d1) / area, 0};
      plane.c = d_[p] - plane.a * u_[p] - plane.b * v_[p];
      const int on = count(plane, kBand_px, vectors);
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
    erase(best, 2 * kBand_px);
  }
  return planes_;
}

}  // namespace kaz::vision
