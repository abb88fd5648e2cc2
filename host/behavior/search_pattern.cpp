// Waypoints of the search and linear interpolation between them.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/search_pattern.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

host::Gaze between(const host::Gaze& a, const host::Gaze& b, double share) {
  return {a.pan_rad + share * (b.pan_rad - a.pan_rad),
          a.tilt_rad + share * (b.tilt_rad - a.tilt_rad)};
}

double distance(const host::Gaze& a, const host::Gaze& b) {
  return std::max(std::abs(a.pan_rad - b.pan_rad), std::abs(a.tilt_rad - b.tilt_rad));
}

}  // namespace

SearchPattern::SearchPattern(const host::Gaze& start, double speed, bool left_first) {
  std::vector<double> rows;
  for (const double tilt : kTiltsDeg) rows.push_back(tilt * kDegree);
  std::stable_sort(rows.begin(), rows.end(), [&](double a, double b) {
    return std::abs(a - start.tilt_rad) < std::abs(b - start.tilt_rad);
  });

  points_.push_back({0, start});
  const auto go = [&](double pan, double tilt) {
    const host::Gaze next{pan, tilt};
    const Point& last = points_.back();
    points_.push_back({last.time + distance(last.gaze, next) / speed, next});
  };
  const bool from_left = start.pan_rad != 0 ? start.pan_rad > 0 : left_first;
  double side = from_left ? kSweepDeg * kDegree : -kSweepDeg * kDegree;
  for (const double tilt : rows) {
    go(side, tilt);
    go(-side, tilt);
    side = -side;
  }
}

host::Gaze SearchPattern::at(double t) const {
  // After the last row the path repeats from the first row's start; three rows end on the other side,
  // so every second round runs backwards.
  const double first = points_[1].time, round = once() - first;
  if (t > once()) {
    const double into = std::fmod(t - first, 2 * round);
    t = first + (into <= round ? into : 2 * round - into);
  }
  const auto after = std::lower_bound(points_.begin(), points_.end(), t,
                                      [](const Point& p, double time) { return p.time < time; });
  if (after == points_.begin()) return points_.front().gaze;
  const auto before = std::prev(after);
  return between(before->gaze, after->gaze, (t - before->time) / (after->time - before->time));
}

}  // namespace kaz::behavior
