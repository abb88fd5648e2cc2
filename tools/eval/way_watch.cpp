// Paths against a thing that has come to rest.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/way_watch.h"

#include <algorithm>
#include <limits>

namespace kaz::tools {
namespace {

using Eigen::Vector2d;

constexpr double kRests = 0.01;  // m/s
// m: the hands reach so far from the middle. Less than that where a path counts as leading around: the map is
// wrong by some centimetres, and its frame drifts.
constexpr double kReach = 0.15, kAround = 0.10;

Vector2d nearest_on(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  const Vector2d line = b - a;
  const double length2 = line.squaredNorm();
  return length2 == 0 ? a : Vector2d(a + std::clamp((p - a).dot(line) / length2, 0.0, 1.0) * line);
}

}  // namespace

void WayWatch::look(Time now, const Vector2d& thing, const Vector2d& robot) {
  const double since = looked_ ? seconds(now - *looked_) : 0;
  const bool rests = since > 0 && (thing - thing_.place()).norm() < kRests * since;
  const bool first = !looked_;
  thing_.x_m = thing.x();
  thing_.y_m = thing.y();
  robot_ = robot;
  looked_ = now;
  if (first || !thing_.slide) return;
  const double distance = distance_to(thing_, robot);
  if (arrived_) {
    nearest_ = std::min(nearest_, distance);
    return;
  }
  // The push may come within a look's time.
  if (seconds(now) < thing_.slide->at_s + 0.05 || !rests) return;
  arrived_ = now;
  away_ = nearest_ = distance;
  in_the_way_ = !path_.empty() && passes(path_) < kReach;
}

void WayWatch::plan(Time now, const std::vector<Vector2d>& path) {
  if (in_the_way_ && !noticed_s_ && path != path_ && (path.empty() || passes(path) >= kAround))
    noticed_s_ = seconds(now - *arrived_);
  path_ = path;
}

double WayWatch::passes(const std::vector<Vector2d>& path) const {
  std::size_t at = 0;  // the robot is on the line from this corner to the next
  double off = std::numeric_limits<double>::infinity();
  Vector2d from = path.front();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vector2d near = nearest_on(path[i], path[i + 1], robot_);
    if ((near - robot_).norm() >= off) continue;
    off = (near - robot_).norm();
    at = i;
    from = near;
  }
  double least = distance_to(thing_, from);
  for (std::size_t i = at + 1; i < path.size(); ++i) {
    const double length = (path[i] - from).norm();
    constexpr double kStep = 0.01;
    for (double d = 0; d < length; d += kStep)
      least = std::min(least, distance_to(thing_, from + d / length * (path[i] - from)));
    from = path[i];
  }
  return std::min(least, distance_to(thing_, from));
}

nlohmann::ordered_json WayWatch::json() const {
  nlohmann::ordered_json json{{"in_the_way", in_the_way_}};
  if (arrived_) {
    json["arrived_s"] = seconds(*arrived_);
    json["away_m"] = away_;
    json["nearest_m"] = nearest_;
  }
  if (noticed_s_) json["noticed_s"] = *noticed_s_;
  return json;
}

}  // namespace kaz::tools
