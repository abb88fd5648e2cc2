// How an episode ended in truth: what the simulator knows and no behaviour does.
// SPDX-License-Identifier: Apache-2.0
//
// Success is decided by truth alone; what a behaviour claims is compared with it, and never part of it but
// where the claim is a number (the direction that search-ball reports). Nothing here is of a behaviour's
// code: bounds and formulas are the judge's own.
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
  std::optional<Eigen::Isometry3d> left_eye = {};  // optical frame: x right, y down, z forward
  std::optional<Eigen::Isometry3d> left_foot = {}, right_foot = {};  // at the ankles, x ahead
  struct Touch {
    std::string thing, by;  // model, "" where nothing is touched; link of the robot
    double at_s = 0;
  };
  Touch touch = {};                            // of something that stands on the floor
  std::optional<Eigen::Vector2d> moving = {};  // of the thing of watch_way()
  std::optional<std::int64_t> unconverged_steps = {};
};

// What an episode is to achieve: the options of its behaviour, as the judge reads them.
struct Task {
  std::string
      name;  // of a behaviour of Kaz; of another one nothing is known but that it may not fall
  double distance_m = 0;       // of go-forward
  double angle_rad = 0;        // of turns, positive to the left
  double seconds = 0;          // of track-ball
  bool ball = false;           // the goal of navigate is to hold the ball
  Eigen::Vector2d goal{0, 0};  // else; from the start, x ahead
  std::optional<double> goal_heading_rad = {};
};
// Errors (usage): a plug-in that is to be judged as `name` lacks an option that the judge reads.
Result<Task> task_of(const std::string& name, const behavior::OptionValues& options);
// Tasks that truth decides: names of Kaz's behaviours.
bool is_judged(const std::string& task);

struct JudgeOptions {
  double ball_radius_m = 0.020;
  bool watches_touch = false;  // whether touched() is to be known, which costs time
  bool lies = false;           // the robot lies at first, and is to get up
};

class Judge final : public Onlooker, public behavior::Sink {
 public:
  explicit Judge(const JudgeOptions& options) : options_(options) {}
  // `name`: model of `thing`, which slides into the way; `world_from_start`: the frame of its place.
  void watch_way(const Obstacle& thing, const std::string& name,
                 const Eigen::Isometry2d& world_from_start);
  // Compares the behaviour's maps with what stands about.
  void watch_map(const std::vector<Obstacle>& obstacles, const Eigen::Isometry2d& world_from_start);
  void look(sim::Simulation& simulation) override;
  // The same of a simulator in another process.
  void look(const Truth& truth);
  void map(const behavior::MapReport& report) override;
  // The behaviour has ended: what comes later (its motors go off) is not looked at.
  void end() { ended_ = true; }

  // The trunk lay farther than 60 degrees from upright, at whatever time; of a robot that lay at first: at
  // the last look.
  bool fell() const;
  // From the first look to the last: along and across the first heading, m; turned, rad.
  double forward_m() const;
  double aside_m() const;
  double heading_rad() const { return heading_; }
  // Something that stands on the floor was touched before any fall: the first one's name, "" if none.
  const std::string& touched() const { return touch_.thing; }
  // What was touched first was still sliding into the way: it hit the robot, not the robot it.
  bool was_hit() const { return was_hit_; }
  // From the first step of the robot, when an ankle has risen by sim::kFirstStep, to the last look, s;
  // nothing before. And from the start of the simulation.
  std::optional<double> walked_s() const;
  double watched_s() const { return seconds(last_.time); }
  // For how long, up to the last look and without a break, s: the ball was clear of the floor; the trunk
  // was upright within 30 degrees and high, its origin above 0.11 m.
  double held_s() const { return lasting_s(held_since_); }
  double upright_s() const { return lasting_s(upright_since_); }
  // Share of the last `seconds` in which the left eye's axis was within 3 degrees of the ball.
  double tracked(double seconds) const;
  // Direction of the ball from the left eye in the trunk's axes at the last look, a unit vector.
  std::optional<Eigen::Vector3d> ball_direction() const;
  // The ball from the midpoint of the ankles at the last look; x ahead, y left, m.
  std::optional<Eigen::Vector2d> ball_from_feet_m() const;
  nlohmann::ordered_json json() const;

 private:
  void look_at_outlines(sim::Simulation& simulation);
  struct Gaze {
    Time time{};
    bool near = false;  // within 3 degrees of the ball
  };
  double lasting_s(const std::optional<Time>& since) const {
    return since ? seconds(last_.time - *since) : 0;
  }

  JudgeOptions options_;
  bool ended_ = false, fell_ = false;
  Truth::Touch touch_;
  bool was_hit_ = false;
  std::optional<WayWatch> way_;
  std::optional<MapTruth> map_;
  std::optional<OwnBody> own_;  // of the first look on
  Eigen::Isometry2d start_from_world_ = Eigen::Isometry2d::Identity();
  std::optional<Eigen::Isometry3d> start_;
  Truth last_;
  double heading_ = 0, last_yaw_ = 0;  // rad; the heading over any number of turns
  std::optional<Time> held_since_, upright_since_, first_step_;
  double left_foot_m_ = 0, right_foot_m_ = 0;  // heights of the ankles at the first look
  std::vector<Gaze> gazes_;                    // each holds until the next
};

// How an episode ended, and what its behaviour says of it.
struct Verdict {
  bool success = false;
  std::string cause = {};  // why not; empty of a success
  bool judged =
      true;  // by truth; false: nothing is known of the task, and the claim counts unless it fell
  bool claim = false;  // the behaviour claims success
};
// By ground truth, of a robot that has not fallen:
// - search-ball: the reported direction (`ball_bearing_deg`, to the left, and `ball_elevation_deg`, up; from
//   the left eye, in the trunk's axes) is within 5 degrees of the ball's,
// - track-ball: the left eye's axis is within 3 degrees of the ball for 90 % of the option `seconds`, up to
//   the end,
// - approach-ball: the ball is where a hand takes it, 100 +- 26 mm ahead of the ankles and 47 +- 27 mm aside,
// - catch-ball: the ball is clear of the floor for the last 3 s,
// - stand, get-up: the trunk is upright and high for the last 3 s,
// - go-forward: the distance within 10 %, the heading within 8 degrees,
// - turn-left, turn-right: the heading within 6 degrees of the option `angle`,
// - navigate: nothing that stands about was touched, and nothing that slides has hit the robot; the goal
//   within 5 cm and, where it has one, its heading within 10 degrees, or the ball as of catch-ball.
// A behaviour that ended with an error has failed. The cause of a failure is a fall or a touch, else what a
// behaviour that admits it names, else what truth lacks.
Verdict verdict_of(const Task& task, const Result<behavior::Outcome>& outcome, const Judge& judge);

}  // namespace kaz::tools
