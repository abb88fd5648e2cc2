// Straight lines between corners of a way, and its legs.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/straighten.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kaz::plan {
namespace {

using Eigen::Vector2d;

constexpr double kSpacing = 0.1;  // m, at most between two candidates for a corner
constexpr double kShort = 1e-9;   // m or rad, no leg
// Of ways that take the same but for rounding the one with the longest lines is taken, which comes first.
constexpr double kSame = 1e-9;  // s

double angle_of(const Vector2d& along) {
  return std::atan2(along.y(), along.x());
}

double turned(double from_rad, double to_rad) {
  return std::remainder(to_rad - from_rad, 2 * std::numbers::pi);
}

// The corners, with the exact ends and points between that are no farther apart than kSpacing.
std::vector<Vector2d> candidates_of(const Pose& start, const Goal& goal,
                                    const std::vector<Vector2d>& corners) {
  std::vector<Vector2d> all{start.position};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i > 0) {
      const Vector2d along = corners[i] - corners[i - 1];
      const int parts = static_cast<int>(std::ceil(along.norm() / kSpacing));
      for (int part = 1; part < parts; ++part)
        all.push_back(corners[i - 1] + along * (static_cast<double>(part) / parts));
    }
    all.push_back(corners[i]);
  }
  all.push_back(goal.position);
  return all;
}

// Of the ways that end by the line from `i` to `j`, the fastest.
struct Best {
  double seconds = std::numeric_limits<double>::infinity();
  std::size_t before = 0;  // where the line to `i` comes from
};

std::vector<Vector2d> fastest(const Clearance& clearance, const Pose& start, const Goal& goal,
                              const PlanOptions& o, const std::vector<Vector2d>& points) {
  const std::size_t n = points.size();
  std::vector<Best> best(n * n);
  std::vector<double> heading(n * n);
  const auto along = [&](std::size_t i, std::size_t j) -> Best& { return best[i * n + j]; };
  for (std::size_t j = 1; j < n; ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const Vector2d line = points[j] - points[i];
      const bool still = line.norm() < kShort;
      double m = clearance.weighted_m(points[i], points[j]);
      // Between neighbours on the way found nothing is in the way; the line may touch a cell beside it.
      if (j == i + 1 && std::isinf(m)) m = line.norm();
      if (std::isinf(m)) continue;
      heading[i * n + j] = angle_of(line);
      const auto turn_s = [&](double from) {
        return still ? 0 : o.turn_s_per_rad * std::abs(turned(from, heading[i * n + j]));
      };
      Best& to = along(i, j);
      if (i == 0) {
        if (still) heading[j] = start.heading_rad;
        to = {turn_s(start.heading_rad) + o.go_s_per_m * m, 0};
        continue;
      }
      for (std::size_t k = 0; k < i; ++k) {
        if (std::isinf(along(k, i).seconds)) continue;
        const double s = along(k, i).seconds + turn_s(heading[k * n + i]) + o.go_s_per_m * m;
        if (s >= to.seconds - kSame) continue;
        to = {s, k};
        if (still) heading[i * n + j] = heading[k * n + i];
      }
    }
  }
  std::size_t i = 0, j = n - 1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < n; ++k) {
    double s = along(k, j).seconds;
    if (goal.heading_rad)
      s += o.turn_s_per_rad * std::abs(turned(heading[k * n + j], *goal.heading_rad));
    if (s >= least - kSame) continue;
    least = s;
    i = k;
  }
  std::vector<Vector2d> way{points[j]};
  while (j != 0) {
    way.push_back(points[i]);
    const std::size_t before = along(i, j).before;
    j = i;
    i = before;
  }
  std::ranges::reverse(way);
  return way;
}

}  // namespace

Path straighten(const Clearance& clearance, const Pose& start, const Goal& goal,
                const PlanOptions& o, const std::vector<Vector2d>& corners) {
  Path path;
  path.corners = corners;
  if (o.any_heading)
    path.corners = fastest(clearance, start, goal, o, candidates_of(start, goal, corners));
  double heading = start.heading_rad;
  const auto turn_to = [&](double to_rad) {
    const double by = turned(heading, to_rad);
    heading = to_rad;
    if (std::abs(by) < kShort) return;
    path.legs.push_back({Leg::Kind::turn, by});
    path.seconds += o.turn_s_per_rad * std::abs(by);
  };
  for (std::size_t i = 1; i < path.corners.size(); ++i) {
    const Vector2d line = path.corners[i] - path.corners[i - 1];
    if (line.norm() < kShort) continue;
    turn_to(angle_of(line));
    path.legs.push_back({Leg::Kind::go, line.norm()});
    path.seconds += o.go_s_per_m * line.norm();
  }
  if (goal.heading_rad) turn_to(*goal.heading_rad);
  return path;
}

}  // namespace kaz::plan
