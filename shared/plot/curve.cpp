// Thinning and clipping of curves.
// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/curve.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace kaz::plot {
namespace {

// Narrows `from`..`to`, the visible part of a segment as shares of its length, to where
// offset + share * step >= 0. False: nothing is left.
bool narrow(double offset, double step, double& from, double& to) {
  if (step == 0) return offset >= 0;
  const double crossing = -offset / step;
  if (step > 0) {
    from = std::max(from, crossing);
  } else {
    to = std::min(to, crossing);
  }
  return from <= to;
}

}  // namespace

std::vector<Point> thinned(std::span<const Point> line) {
  std::vector<Point> kept;
  const auto by_height = [](const Point& a, const Point& b) { return a.y < b.y; };
  for (auto from = line.begin(); from != line.end();) {
    auto to = from;
    while (to != line.end() && std::floor(to->x) == std::floor(from->x)) ++to;
    auto [low, high] = std::minmax_element(from, to, by_height);
    if (low > high) std::swap(low, high);
    for (const Point& point : {*from, *low, *high, *std::prev(to)}) {
      if (kept.empty() || kept.back() != point) kept.push_back(point);
    }
    from = to;
  }
  return kept;
}

std::vector<std::vector<Point>> clipped(std::span<const Point> line, const Rectangle& area) {
  std::vector<std::vector<Point>> pieces;
  bool open = false;  // the last piece ends at the start of the segment
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Point a = line[i - 1], b = line[i];
    const Point step{b.x - a.x, b.y - a.y};
    double from = 0, to = 1;
    const bool visible = narrow(a.x - area.left, step.x, from, to) &&
                         narrow(area.right() - a.x, -step.x, from, to) &&
                         narrow(a.y - area.top, step.y, from, to) &&
                         narrow(area.bottom() - a.y, -step.y, from, to);
    if (!visible) {
      open = false;
      continue;
    }
    const auto at = [&](double share) {
      return Point{std::clamp(a.x + share * step.x, area.left, area.right()),
                   std::clamp(a.y + share * step.y, area.top, area.bottom())};
    };
    if (!open) pieces.push_back({from > 0 ? at(from) : a});
    pieces.back().push_back(to < 1 ? at(to) : b);
    open = to >= 1;
  }
  return pieces;
}

std::vector<Point> distinct(std::span<const Point> points, const Rectangle& area) {
  std::set<std::pair<long, long>> taken;
  std::vector<Point> kept;
  for (const Point& p : points) {
    if (p.x < area.left || p.x > area.right() || p.y < area.top || p.y > area.bottom()) continue;
    if (taken.insert({std::lround(2 * p.x), std::lround(2 * p.y)}).second) kept.push_back(p);
  }
  return kept;
}

}  // namespace kaz::plot
