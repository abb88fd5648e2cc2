// Edges along rays, and a robust linear fit.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/outline_edges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

#include "vision/color/outline_hypotheses.h"

namespace kaz::vision {
namespace {

using Rgb = Eigen::Vector3f;
using Unknowns = Eigen::Matrix<double, 5, 1>;  // radius, center u and v (px), cos2, sin2

bool can_sample(const Image& image, double u, double v) {
  return u >= 0 && v >= 0 && u <= image.width - 1.001 && v <= image.height - 1.001;
}

// Bilinear color at a point within the picture.
Rgb color_at(const Image& image, double u, double v) {
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const auto fu = static_cast<float>(u - x), fv = static_cast<float>(v - y);
  const auto row = 3 * static_cast<std::size_t>(image.width);
  const std::uint8_t* top =
      &image.rgb[static_cast<std::size_t>(y) * row + 3 * static_cast<std::size_t>(x)];
  const std::uint8_t* low = top + row;
  Rgb color;
  for (int i = 0; i < 3; ++i) {
    const float above = static_cast<float>(top[i]) * (1 - fu) + static_cast<float>(top[i + 3]) * fu;
    const float below = static_cast<float>(low[i]) * (1 - fu) + static_cast<float>(low[i + 3]) * fu;
    color[i] = above * (1 - fv) + below * fv;
  }
  return color;
}

RayEdge edge_on(const Image& image, const BallOutline& outline, const RayDirection& way,
                double reach_px) {
  // An edge is the difference of the means of three samples on both sides.
  constexpr int kBeside = 3, kMostSamples = 64;
  const double step = std::max(0.5, 0.03 * outline.radius_px);
  const int side = std::max(2, static_cast<int>(reach_px / step + 0.5));
  const int count = 2 * (side + kBeside) + 1;
  if (count > kMostSamples) return {};
  const double middle = outline.radius_at(way.cosine, way.sine);
  const auto radius_of = [&](int i) { return std::max(0.0, middle + (i - side - kBeside) * step); };
  std::array<Rgb, kMostSamples> color;
  for (int i = 0; i < count; ++i) {
    const double u = outline.center_u + radius_of(i) * way.cosine;
    const double v = outline.center_v + radius_of(i) * way.sine;
    if (!can_sample(image, u, v)) return {};
    color[static_cast<std::size_t>(i)] = color_at(image, u, v);
  }
  RayEdge best{true, middle, 0, 0};
  double most = 0;
  for (int i = kBeside; i + kBeside < count; ++i) {
    const Rgb* at = &color[static_cast<std::size_t>(i)];
    const Rgb inner = at[-1] + at[-2] + at[-3], outer = at[1] + at[2] + at[3];
    const double change = (outer - inner).norm();
    const double contrast =
        change / (outer.norm() + inner.norm() + 60);  // 60: 20 codes for each sample
    const double off = (i - side - kBeside) * step / reach_px;
    const double weighted = contrast * (1 - 0.4 * off * off);  // of equal edges, the nearer one
    if (weighted <= most) continue;
    most = weighted;
    best = {true, radius_of(i), change / kBeside, contrast};
  }
  return best;
}

// The unknowns that reduce the weighted residuals of the edges, after some rounds of reweighting.
class RobustFit {
 public:
  RobustFit(const BallOutline& outline, const RayEdges& edges) : outline_(outline) {
    for (std::size_t k = 0; k < kOutlineRays; ++k) {
      if (!edges[k].seen) continue;
      const auto [c, s] = outline_rays()[k];
      const double r = outline.radius_px;
      Row row;
      row.gradient << 1, c, s, r * (c * c - s * s), r * 2 * c * s;
      row.off_px = edges[k].radius - outline.radius_at(c, s);
      row.weight = std::min(1.0, edges[k].contrast / 0.2);
      rows_.push_back(row);
    }
  }

  // False if too few edges agree.
  bool improve() {
    constexpr std::size_t kFewest = 10;
    if (rows_.size() < kFewest) return false;
    std::vector<double> sizes;
    for (const Row& row : rows_) sizes.push_back(std::abs(row.off_px - row.gradient.dot(change_)));
    const auto half = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), half, sizes.end());
    const double cut = 3 * std::max({0.5, 0.02 * outline_.radius_px, *half});
    // Priors: a weak one against change, and one against ovals, by the squared radius.
    const double oval = 0.6 * outline_.radius_px * outline_.radius_px;
    Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
    normal.diagonal() << 0.3, 0.3, 0.3, oval, oval;
    Unknowns right = Unknowns::Zero();
    right[3] = -oval * (outline_.cos2 + change_[3]);
    right[4] = -oval * (outline_.sin2 + change_[4]);
    double weights = 0;
    for (const Row& row : rows_) {
      const double left_px = row.off_px - row.gradient.dot(change_), q = left_px / cut;
      if (std::abs(q) >= 1) continue;
      const double weight = row.weight * (1 - q * q) * (1 - q * q);  // Tukey
      normal += weight * row.gradient * row.gradient.transpose();
      right += weight * left_px * row.gradient;
      weights += weight;
    }
    if (weights < 3) return false;
    const Unknowns step = normal.ldlt().solve(right);
    change_ += step;
    return step.allFinite();
  }
  const Unknowns& change() const { return change_; }

 private:
  struct Row {
    Unknowns gradient;
    double off_px, weight;
  };
  const BallOutline& outline_;
  std::vector<Row> rows_;
  Unknowns change_ = Unknowns::Zero();
};

}  // namespace

const std::array<RayDirection, kOutlineRays>& outline_rays() {
  static const std::array<RayDirection, kOutlineRays> all = [] {
    std::array<RayDirection, kOutlineRays> rays{};
    for (std::size_t k = 0; k < kOutlineRays; ++k) {
      const double turn = 2 * std::numbers::pi * static_cast<double>(k) / kOutlineRays;
      rays[k] = {std::cos(turn), std::sin(turn)};
    }
    return rays;
  }();
  return all;
}

bool RayEdge::strong() const {
  constexpr double kNoiseCodes = 14, kNoiseContrast = 0.08;
  return seen && step_codes > kNoiseCodes && contrast > kNoiseContrast;
}

RayEdges edges_near(const Image& image, const BallOutline& outline, double reach_px) {
  RayEdges edges;
  for (std::size_t k = 0; k < kOutlineRays; ++k)
    edges[k] = edge_on(image, outline, outline_rays()[k], reach_px);
  return edges;
}

bool fit_to_edges(BallOutline& outline, const RayEdges& edges) {
  RobustFit fit(outline, edges);
  for (int round = 0; round < 6; ++round)
    if (!fit.improve()) return false;
  const Unknowns& change = fit.change();
  outline.radius_px += change[0];
  outline.center_u += change[1];
  outline.center_v += change[2];
  outline.cos2 += change[3];
  outline.sin2 += change[4];
  const double oval = std::hypot(outline.cos2, outline.sin2);
  if (oval > kMaxOval) {
    outline.cos2 *= kMaxOval / oval;
    outline.sin2 *= kMaxOval / oval;
  }
  return outline.radius_px > kMinOutlineRadius_px;
}

}  // namespace kaz::vision
