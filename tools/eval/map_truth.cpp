// Outlines in view, and cells of the map, against the obstacles' true places.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/map_truth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/map/local_map.h"

namespace kaz::tools {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr double kStep = 0.01, kWithin = 1.0;  // m
constexpr double kLookEvery_s = 0.1, kInView_s = 0.5, kRecent_s = 2;
constexpr double kFoundWithin = 0.025, kClear = 0.02;  // m
constexpr double kAboveFloor = 0.01;  // m, of an outline's point, below which it is in shadow

std::vector<Vector2d> outline_of(const Obstacle& o) {
  std::vector<Vector2d> points;
  const Eigen::Rotation2Dd turn(o.yaw_rad);
  if (o.shape != Shape::box) {
    const double radius = o.length_m / 2;
    const int count = static_cast<int>(2 * std::numbers::pi * radius / kStep) + 1;
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count;
      points.push_back(o.place() + radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
    return points;
  }
  const Vector2d half(o.length_m / 2, o.width_m / 2);
  for (const int axis : {0, 1}) {
    const int count = static_cast<int>(2 * half[axis] / kStep) + 1;
    for (const double side : {-1.0, 1.0}) {
      for (int i = 0; i <= count; ++i) {
        Vector2d at;
        at[axis] = half[axis] * (2.0 * i / count - 1);
        at[1 - axis] = side * half[1 - axis];
        points.push_back(o.place() + turn * at);
      }
    }
  }
  return points;
}

bool near(const std::vector<Obstacle>& all, const Vector2d& at, double within_m) {
  return std::ranges::any_of(all, [&](const Obstacle& o) { return distance_to(o, at) < within_m; });
}

}  // namespace

MapTruth::MapTruth(const std::vector<Obstacle>& obstacles) {
  for (const Obstacle& o : obstacles) {
    const bool fixed = !o.slide && o.shape != Shape::ball;
    (fixed ? fixed_ : loose_).push_back(o);
    if (o.slide) loose_.push_back(at_rest(o));
  }
  for (const Obstacle& o : fixed_)
    for (const Vector2d& at : outline_of(o))
      if (!near(loose_, at, 0.3)) outline_.push_back({at, 0, {}});
}

// By things on the way, not by that of which it is the outline: just before it the way is free.
bool MapTruth::hidden(const Vector2d& from, const Vector2d& at) const {
  const Vector2d way = at - from;
  const double length = way.norm();
  return std::ranges::any_of(fixed_, [&](const Obstacle& o) {
    // Most things are far from the way.
    const double along = std::clamp(way.dot(o.place() - from) / way.squaredNorm(), 0.0, 1.0);
    const double reach =
        0.5 * std::hypot(o.length_m, o.shape == Shape::box ? o.width_m : 0) + kStep;
    if ((from + along * way - o.place()).norm() > reach) return false;
    for (double m = kStep; m < length - kStep; m += kStep) {
      if (distance_to(o, from + m / length * way) < 1e-6) return true;
    }
    return false;
  });
}

bool MapTruth::looks_at(Time now) const {
  return looked_ < Time::zero() || seconds(now - looked_) >= kLookEvery_s;
}

void MapTruth::look(Time now, const Eigen::Isometry3d& start_from_eye,
                    const vision::CameraModel& camera, const OwnBody* own) {
  if (!looks_at(now)) return;
  const double since = looked_ < Time::zero() ? kLookEvery_s : seconds(now - looked_);
  looked_ = now;
  const Eigen::Isometry3d eye_from_start = start_from_eye.inverse();
  const Vector2d eye = start_from_eye.translation().head<2>();
  const Vector3d left = start_from_eye.translation(),
                 right = start_from_eye * Vector3d(camera.baseline_m, 0, 0);
  for (Outline& one : outline_) {
    if ((one.at - eye).norm() > kWithin) continue;
    const Vector3d at(one.at.x(), one.at.y(), kAboveFloor), p = eye_from_start * at;
    if (p.z() < 0.1) continue;
    const Vector2d px = camera.pixel(p);
    const double u = px.x(), v = px.y();
    const double in_right = u - camera.fx * camera.baseline_m / p.z();
    if (in_right < 0 || v < 0 || u > camera.width - 1 || v > camera.height - 1 ||
        hidden(eye, one.at))
      continue;
    // One eye alone has no depth.
    if (own != nullptr && (own->hides(left, at) || own->hides(right, at))) continue;
    one.seen_s += std::min(since, 2 * kLookEvery_s);
    one.newest = now;
  }
}

void MapTruth::compare(const behavior::MapReport& report, const Eigen::Isometry2d& robot) {
  const Eigen::Isometry2d thought =
      Eigen::Translation2d(report.robot) * Eigen::Rotation2Dd(report.heading_rad);
  const Eigen::Isometry2d map_from_start = thought * robot.inverse(),
                          start_from_map = map_from_start.inverse();
  const map::LocalMap& map = report.map;
  const auto state = [&](const Vector2d& in_map) { return map.certain_at(in_map.x(), in_map.y()); };
  const int reach = static_cast<int>(kFoundWithin / map.options().cell_m) + 1;
  for (const Outline& one : outline_) {
    if (one.seen_s < kInView_s || (one.at - robot.translation()).norm() > kWithin) continue;
    const Vector2d at = map_from_start * one.at;
    bool found = false;
    for (int x = -reach; x <= reach && !found; ++x) {
      for (int y = -reach; y <= reach && !found; ++y) {
        const Vector2d off = map.options().cell_m * Vector2d(x, y);
        found = off.norm() <= kFoundWithin && state(at + off) == map::CellState::obstacle;
      }
    }
    ++points_;
    found_ += found ? 1 : 0;
    if (seconds(report.time - one.newest) > kRecent_s) continue;
    ++points_in_view_;
    found_in_view_ += found ? 1 : 0;
  }
  for (int x = map.number(report.robot.x() - kWithin); x <= map.number(report.robot.x() + kWithin);
       ++x) {
    for (int y = map.number(report.robot.y() - kWithin);
         y <= map.number(report.robot.y() + kWithin); ++y) {
      const map::CellState is = map.certain(x, y);
      const Vector2d in_map(map.middle(x), map.middle(y));
      if (is == map::CellState::unknown || (in_map - report.robot).norm() > kWithin) continue;
      const Vector2d at = start_from_map * in_map;
      if (near(fixed_, at, kClear) || near(loose_, at, 0.3)) continue;
      ++cells_;
      wrong_ += is == map::CellState::obstacle ? 1 : 0;
    }
  }
}

nlohmann::ordered_json MapTruth::json() const {
  return {{"outline_points", points_},
          {"outline_found", found_},
          {"outline_points_in_view", points_in_view_},
          {"outline_found_in_view", found_in_view_},
          {"floor_cells", cells_},
          {"floor_wrong", wrong_}};
}

}  // namespace kaz::tools
