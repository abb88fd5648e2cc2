// Circles by random sampling, ellipse by moments.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/outline_hypotheses.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

namespace kaz::vision {
namespace {

BallOutline circle_at(double u, double v, double radius) {
  BallOutline circle;
  circle.center_u = u;
  circle.center_v = v;
  circle.radius_px = radius;
  return circle;
}

std::optional<BallOutline> circle_through(const OutlinePoint& a, const OutlinePoint& b,
                                          const OutlinePoint& c) {
  const double bu = b.u - a.u, bv = b.v - a.v, cu = c.u - a.u, cv = c.v - a.v;
  const double det = 2 * (bu * cv - bv * cu);
  if (std::abs(det) < 1e-6) return std::nullopt;
  const double b2 = bu * bu + bv * bv, c2 = cu * cu + cv * cv;
  const double u = (cv * b2 - bv * c2) / det, v = (bu * c2 - cu * b2) / det;
  return circle_at(a.u + u, a.v + v, std::hypot(u, v));
}

// Share of the circle's sectors with a point within the tolerance, whose step leads outwards, less the share
// of points outside of the circle.
double agreement(const BallOutline& circle, std::span<const OutlinePoint> points) {
  constexpr unsigned kSectors = 32;
  std::uint32_t seen = 0;
  std::size_t outside = 0;
  const double tolerance = std::max(0.8, 0.08 * circle.radius_px);
  for (const OutlinePoint& p : points) {
    const double du = p.u - circle.center_u, dv = p.v - circle.center_v;
    const double length = std::hypot(du, dv);
    if (length > circle.radius_px + tolerance) ++outside;
    if (std::abs(length - circle.radius_px) > tolerance) continue;
    if (du * p.step_u + dv * p.step_v < 0.3 * length) continue;
    const double turn = std::atan2(dv, du) / (2 * std::numbers::pi) + 0.5;
    seen |= std::uint32_t{1} << (static_cast<unsigned>(turn * kSectors) % kSectors);
  }
  return static_cast<double>(std::popcount(seen)) / kSectors -
         static_cast<double>(outside) / static_cast<double>(points.size());
}

BallOutline sampled_circle(const BallOutline& box, std::span<const OutlinePoint> points) {
  constexpr int kTrials = 60;
  constexpr std::size_t kJudges = 160;  // points; more do not change the choice
  std::vector<OutlinePoint> judges;
  const std::size_t stride = points.size() / kJudges + 1;
  for (std::size_t i = 0; i < points.size(); i += stride) judges.push_back(points[i]);
  std::uint64_t state = 0;
  const auto pick = [&]() -> const OutlinePoint& {
    state = state * 6364136223846793005U + 1442695040888963407U;  // Knuth's LCG for 64 bits
    return points[(state >> 33) % points.size()];
  };
  BallOutline best = box;
  double most = agreement(box, judges);
  for (int trial = 0; trial < kTrials; ++trial) {
    const OutlinePoint &a = pick(), &b = pick(), &c = pick();
    const std::optional<BallOutline> circle = circle_through(a, b, c);
    if (!circle || circle->radius_px > 2.4 * box.radius_px + 2 ||
        circle->radius_px < kMinOutlineRadius_px)
      continue;
    const double agrees = agreement(*circle, judges);
    if (agrees <= most) continue;
    most = agrees;
    best = *circle;
  }
  return best;
}

BallOutline moments_ellipse(const Region& region) {
  double uu = 0, uv = 0, vv = 0;
  for (const Run& run : region.runs) {
    const double dv = run.row - region.centroid_y;
    for (int u = run.left; u <= run.right; ++u) {
      const double du = u - region.centroid_x;
      uu += du * du;
      uv += du * dv;
      vv += dv * dv;
    }
  }
  const double sum = std::max(uu + vv, 1e-9);
  BallOutline ellipse =
      circle_at(region.centroid_x, region.centroid_y, std::sqrt(2 * sum / region.area));
  ellipse.cos2 = std::clamp(0.5 * (uu - vv) / sum, -kMaxOval, kMaxOval);
  ellipse.sin2 = std::clamp(uv / sum, -kMaxOval, kMaxOval);
  return ellipse;
}

}  // namespace

std::vector<BallOutline> outline_hypotheses(const Region& region,
                                            std::span<const OutlinePoint> points) {
  std::vector<BallOutline> all;
  if (points.size() < 6) return all;
  const BallOutline box =
      circle_at(0.5 * (region.left + region.right), 0.5 * (region.top + region.bottom),
                0.5 * (std::max(region.right - region.left, region.bottom - region.top) + 1));
  for (const BallOutline& outline : {sampled_circle(box, points), moments_ellipse(region), box})
    if (outline.radius_px > kMinOutlineRadius_px) all.push_back(outline);
  return all;
}

}  // namespace kaz::vision
