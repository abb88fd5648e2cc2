// Checks whether a robot noticed an object that was moved into its way.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "host/behavior/sink.h"
#include "shared/base/time.hpp"
#include "tools/app/evaluate/obstacle.h"

namespace kaz::tools {

// Uses the object's true position and the paths that the behavior reports. Frame: between the feet at the
// start; m. The object is in the way if it comes to rest less than 0.15 m (the reach of the hands) from the
// remaining path. It was noticed if a later plan avoids it by 0.10 m or finds no path.
class WayWatch {
 public:
  // `thing` slides. `name`: its model.
  WayWatch(const Obstacle& thing, std::string name) : thing_(thing), name_(std::move(name)) {}

  const std::string& name() const { return name_; }
  // Call at each look, with the true positions of object and robot.
  void look(Time now, const Eigen::Vector2d& thing, const Eigen::Vector2d& robot);
  // Call after each plan.
  void plan(Time now, const std::vector<Eigen::Vector2d>& path);

  bool arrived() const { return arrived_.has_value(); }
  bool in_the_way() const { return in_the_way_; }
  // Time in s from its arrival to the plan that avoids it.
  std::optional<double> noticed_s() const { return noticed_s_; }
  // `in_the_way`, `arrived_s`, `away_m` (distance from the robot's center to the object's wall at its
  // arrival), `nearest_m` (the smallest such distance since then), `noticed_s`.
  nlohmann::ordered_json json() const;

 private:
  // Least distance from the object's wall to the remaining path.
  double passes(const std::vector<Eigen::Vector2d>& path) const;

  Obstacle thing_;  // at its present position
  std::string name_;
  Eigen::Vector2d robot_{0, 0};
  std::optional<Time> looked_, arrived_;
  std::vector<Eigen::Vector2d> path_;
  bool in_the_way_ = false;
  double away_ = 0, nearest_ = 0;
  std::optional<double> noticed_s_;
};

}  // namespace kaz::tools
