// How an episode ended in truth: what the simulator knows and no behaviour does.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "tools/app/evaluate/way_watch.h"
#include "tools/app/session/session.h"

namespace kaz::tools {

constexpr double kClearOfFloor_m = 0.02;  // under a ball that is lifted

class Judge final : public Onlooker {
 public:
  // `watches_touch`: whether touched() is to be known, which costs time.
  explicit Judge(double ball_radius_m, bool watches_touch = false)
      : ball_radius_m_(ball_radius_m), watches_touch_(watches_touch) {}
  // `name`: model of `thing`, which slides into the way; `world_from_start`: the frame of its place.
  void watch_way(const Obstacle& thing, const std::string& name,
                 const Eigen::Isometry2d& world_from_start);
  void look(sim::Simulation& simulation) override;
  void map(const behavior::MapReport& report) override;

  // The trunk lay farther than 60 degrees from upright, at whatever time.
  bool fell() const { return fell_; }
  // From the first look to the last: along and across the first heading, m; turned, rad.
  double forward_m() const;
  double aside_m() const;
  double heading_rad() const { return heading_; }
  // Something that stands on the floor was touched before any fall: the first one's name, "" if none.
  const std::string& touched() const { return touch_.thing; }
  // What was touched first was still sliding into the way: it hit the robot, not the robot it.
  bool was_hit() const { return was_hit_; }
  // For how long, up to the last look, the ball was lifted clear of the floor without a break, s.
  double held_s() const;
  nlohmann::ordered_json json() const;

 private:
  double ball_radius_m_;
  bool watches_touch_;
  bool fell_ = false;
  struct Touch {
    std::string thing, by;  // model; link of the robot
    double at_s = 0;
  };
  static Touch touch_now(const sim::World& world);
  Touch touch_;
  bool was_hit_ = false;
  std::optional<WayWatch> way_;
  Eigen::Isometry2d start_from_world_ = Eigen::Isometry2d::Identity();
  std::optional<Eigen::Isometry3d> start_;
  Eigen::Isometry3d last_ = Eigen::Isometry3d::Identity();
  double heading_ = 0, last_yaw_ = 0;  // rad; the heading over any number of turns
  bool has_ball_ = true;
  std::optional<std::int64_t> unconverged_steps_;  // of the dynamics, where they are counted
  Time now_{};
  std::optional<Time> lifted_;
  Eigen::Vector3d ball_ = Eigen::Vector3d::Zero();
};

// Why an episode does not count as a success; empty where it does. A behaviour's success must hold by
// ground truth:
// - catch-ball: the ball is held clear of the floor for the last 3 s,
// - go-forward: the distance within 10 %, the heading within 8 degrees,
// - turn-left, turn-right: the heading within 6 degrees of the option `angle`,
// - navigate: nothing that stands about was touched, and nothing that slides has hit the robot; the goal
//   within 5 cm and, where it has one, its heading within 10 degrees, or the ball as of catch-ball,
// - all: the robot has not fallen.
// `options`: the behaviour's options.
std::string cause_of_failure(const std::string& behavior, const behavior::OptionValues& options,
                             const Result<behavior::Outcome>& outcome, const Judge& judge);

}  // namespace kaz::tools
