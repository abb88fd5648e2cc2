// Rays over the map, and the greedy choice among views.
// SPDX-License-Identifier: Apache-2.0
#include "host/map/next_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/base/angle.hpp"

namespace kaz::map {
namespace {

using Eigen::Vector2d;

constexpr double kRay = 1 * kDegree;                 // from one to the next
constexpr double kBeside = 0.25, kElsewhere = 0.15;  // m, from the path; weight farther from it

double distance(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

double weight(const Vector2d& p, std::span<const Vector2d> path) {
  for (std::size_t i = 1; i < path.size(); ++i)
    if (distance(p, path[i - 1], path[i]) < kBeside) return 1;
  return path.size() < 2 ? 1 : kElsewhere;
}

// Weighted area, m^2, of the unknown floor that a ray as wide as kRay shows: the sum of w r dr kRay.
double unknown_along(const LocalMap& map, const Viewpoint& from, double bearing,
                     std::span<const Vector2d> path) {
  const Vector2d ahead(std::cos(bearing), std::sin(bearing));
  const double step = 0.5 * map.options().cell_m;  // passes through no wall of one cell
  double sum = 0;
  for (double r = from.nearest_m; r < from.farthest_m; r += step) {
    const Vector2d at = from.eye + r * ahead;
    const CellState state = map.at(at.x(), at.y()).state;
    if (state == CellState::obstacle) break;
    if (state == CellState::unknown) sum += weight(at, path) * r * step * kRay;
  }
  return sum;
}

}  // namespace

std::vector<double> directions_worth_a_look(const LocalMap& map, const Viewpoint& from,
                                            std::span<const double> candidates,
                                            std::span<const Vector2d> path, double worth_m2) {
  struct Ray {
    double direction, unknown_m2;
  };
  std::vector<Ray> rays;
  const int half = static_cast<int>(std::numbers::pi / kRay);
  for (int i = -half; i < half; ++i) {
    const double direction = i * kRay;
    const auto in_view = [&](double one) {
      return std::abs(one - direction) <= from.half_view_rad;
    };
    if (std::ranges::any_of(candidates, in_view))
      rays.push_back({direction, unknown_along(map, from, from.heading_rad + direction, path)});
  }
  std::vector<double> chosen;
  while (chosen.size() < candidates.size()) {
    double best = 0, most = 0;
    for (const double candidate : candidates) {
      double sum = 0;
      for (const Ray& ray : rays)
        if (std::abs(ray.direction - candidate) <= from.half_view_rad) sum += ray.unknown_m2;
      if (sum > most) most = sum, best = candidate;
    }
    if (most < worth_m2) break;
    chosen.push_back(best);
    for (Ray& ray : rays)
      if (std::abs(ray.direction - best) <= from.half_view_rad) ray.unknown_m2 = 0;
  }
  return chosen;
}

}  // namespace kaz::map
