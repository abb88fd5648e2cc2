// Checks whether a robot noticed an object that was moved into the robot's way.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "host/behavior/sink.h"
#include "shared/base/time.hpp"
#include "tools/eval/obstacle.h"

namespace kaz::tools {

// Uses the object's true position and the paths that the behavior reports. Coordinate frame: origin between
// the feet of the robot at the start; m. The object is in the way if its final position is less than 0.15 m
// (the reach of the hands) from the remaining path. The object was noticed if a later plan finds no path, or
// passes the object at a distance of at least 0.10 m.
class WayWatch {
 public:
  // `thing`: the sliding object. `name`: model name of this object.
  WayWatch(const Obstacle& thing, std::string name) : thing_(thing), name_(std::move(name)) {}

  const std::string& name() const { return name_; }
  // Call look() at each look of the judge, with the true positions of object and robot.
  void look(Time now, const Eigen::Vector2d& thing, const Eigen::Vector2d& robot);
  // Call plan() after each plan of the behavior.
  void plan(Time now, const std::vector<Eigen::Vector2d>& path);

  bool arrived() const { return arrived_.has_value(); }
  bool in_the_way() const { return in_the_way_; }
  // Time in s from the object's arrival to the plan that avoids the object.
  std::optional<double> noticed_s() const { return noticed_s_; }
  // Returns `in_the_way`, `arrived_s`, `away_m`, `nearest_m` and `noticed_s`. `away_m` is the distance from
  // the robot's center to the object's wall at the object's arrival. `nearest_m` is the smallest distance
  // from the robot's center to the object's wall since the object's arrival.
  nlohmann::ordered_json json() const;

 private:
  // Returns the smallest distance from the object's wall to the remaining path.
  double passes(const std::vector<Eigen::Vector2d>& path) const;

  Obstacle thing_;  // the object at its present position
  std::string name_;
  Eigen::Vector2d robot_{0, 0};
  std::optional<Time> looked_, arrived_;
  std::vector<Eigen::Vector2d> path_;
  bool in_the_way_ = false;
  double away_ = 0, nearest_ = 0;
  std::optional<double> noticed_s_;
};

}  // namespace kaz::tools
