// How an episode ended in truth: what the simulator knows and no behaviour does.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "tools/app/evaluate/map_truth.h"
#include "tools/app/evaluate/way_watch.h"
#include "tools/app/session/session.h"

namespace kaz::tools {

constexpr double kClearOfFloor_m = 0.02;  // under a ball that is lifted

// What the simulator knows at one time. World frame; m.
struct Truth {
  Time time{};
  Eigen::Isometry3d trunk = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Vector3d> ball = {};
  struct Touch {
    std::string thing, by;  // model, "" where nothing is touched; link of the robot
    double at_s = 0;
  };
  Touch touch = {};                            // of something that stands on the floor
  std::optional<Eigen::Vector2d> moving = {};  // of the thing of watch_way()
  std::optional<std::int64_t> unconverged_steps = {};
};

class Judge final : public Onlooker, public behavior::Sink {
 public:
  // `watches_touch`: whether touched() is to be known, which costs time.
  // `sees_end`: the last look is at the behaviour's end; in another process it lies somewhere after it.
  explicit Judge(double ball_radius_m, bool watches_touch = false, bool sees_end = true)
      : ball_radius_m_(ball_radius_m), watches_touch_(watches_touch), sees_end_(sees_end) {}
  // `name`: model of `thing`, which slides into the way; `world_from_start`: the frame of its place.
  void watch_way(const Obstacle& thing, const std::string& name,
                 const Eigen::Isometry2d& world_from_start);
  // Compares the behaviour's maps with what stands about.
  void watch_map(const std::vector<Obstacle>& obstacles, const Eigen::Isometry2d& world_from_start);
  void look(sim::Simulation& simulation) override;
  // The same of a simulator in another process.
  void look(const Truth& truth);
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
  // For how long, up to the last look, the ball was lifted clear of the floor without a break, s; where the
  // end is not seen, for how long at most.
  double held_s() const;
  nlohmann::ordered_json json() const;

 private:
  double ball_radius_m_;
  bool watches_touch_, sees_end_;
  bool fell_ = false;
  Truth::Touch touch_;
  bool was_hit_ = false;
  std::optional<WayWatch> way_;
  std::optional<MapTruth> map_;
  Eigen::Isometry2d start_from_world_ = Eigen::Isometry2d::Identity();
  std::optional<Eigen::Isometry3d> start_;
  Eigen::Isometry3d last_ = Eigen::Isometry3d::Identity();
  double heading_ = 0, last_yaw_ = 0;  // rad; the heading over any number of turns
  bool has_ball_ = true;
  std::optional<std::int64_t> unconverged_steps_;  // of the dynamics, where they are counted
  Time now_{};
  std::optional<Time> lifted_;
  double longest_held_s_ = 0;
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
