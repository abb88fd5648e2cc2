// Whether a robot took note of a thing that was put into its way.
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

// By the thing's true place and the paths that the behaviour reports. Frame: from between the feet of the
// start; m. The thing lies in the way if, as it comes to rest, what is left of the path leads nearer to it
// than the robot is wide. It was noticed if a later plan leads around it, or finds no way.
class WayWatch {
 public:
  // `thing` slides; `name`: its model.
  WayWatch(const Obstacle& thing, std::string name) : thing_(thing), name_(std::move(name)) {}

  const std::string& name() const { return name_; }
  // At each look: true places of thing and robot.
  void look(Time now, const Eigen::Vector2d& thing, const Eigen::Vector2d& robot);
  // After each plan.
  void plan(Time now, const std::vector<Eigen::Vector2d>& path);

  bool arrived() const { return arrived_.has_value(); }
  bool in_the_way() const { return in_the_way_; }
  // From when it lay there to the plan that took note, s.
  std::optional<double> noticed_s() const { return noticed_s_; }
  // `in_the_way`, `arrived_s`, `away_m` (from the robot's middle to the thing's wall then), `nearest_m` (the
  // least of it since then), `noticed_s`.
  nlohmann::ordered_json json() const;

 private:
  // Least distance from the thing's wall of what is left of the path.
  double passes(const std::vector<Eigen::Vector2d>& path) const;

  Obstacle thing_;  // as it is now
  std::string name_;
  Eigen::Vector2d robot_{0, 0};
  std::optional<Time> looked_, arrived_;
  std::vector<Eigen::Vector2d> path_;
  bool in_the_way_ = false;
  double away_ = 0, nearest_ = 0;
  std::optional<double> noticed_s_;
};

}  // namespace kaz::tools
