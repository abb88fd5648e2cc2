// Decides from the simulator's ground truth how an episode ended.
// SPDX-License-Identifier: Apache-2.0
//
// Ground truth alone decides success. A behavior's claim is compared with it, but never part of it. The
// exception is a claimed number (the direction that search-ball reports). The judge uses its own bounds and
// formulas, and no code of a behavior.
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

constexpr double kClearOfFloor_m = 0.02;  // height under a ball that counts as lifted

// Ground truth at one time. World frame; m.
struct Truth {
  Time time{};
  Eigen::Isometry3d trunk = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Vector3d> ball = {};
  std::optional<Eigen::Isometry3d> left_eye = {};  // optical frame: x right, y down, z forward
  std::optional<Eigen::Isometry3d> left_foot = {}, right_foot = {};  // at the ankles, x ahead
  struct Touch {
    std::string thing, by;  // thing: model, "" without contact; by: link of the robot
    double at_s = 0;
  };
  Touch touch = {};                            // contact with an object that stands on the floor
  std::optional<Eigen::Vector2d> moving = {};  // position of the object of watch_way()
  std::optional<std::int64_t> unconverged_steps = {};
};

// Goal of an episode: the options of its behavior that the judge needs.
struct Task {
  // Behavior of Kaz. Any other task counts as the behavior claims, unless the robot falls.
  std::string name;
  double distance_m = 0;       // for go-forward
  double angle_rad = 0;        // for turns, positive to the left
  double seconds = 0;          // for track-ball
  bool ball = false;           // navigate must hold the ball
  Eigen::Vector2d goal{0, 0};  // otherwise its goal; from the start, x ahead
  std::optional<double> goal_heading_rad = {};
};
// Fails (usage) if a plug-in that is judged as `name` lacks an option that the judge needs.
Result<Task> task_of(const std::string& name, const behavior::OptionValues& options);
// Returns whether ground truth decides this task, which is the name of a behavior of Kaz.
bool is_judged(const std::string& task);

struct JudgeOptions {
  double ball_radius_m = 0.020;
  bool watches_touch = false;  // records touched(), which costs time
  bool lies = false;           // the robot lies at first, and must get up
};

class Judge final : public Onlooker, public behavior::Sink {
 public:
  explicit Judge(const JudgeOptions& options) : options_(options) {}
  // Watches `thing`, which slides into the way. `name`: its model. `world_from_start`: frame of its position.
  void watch_way(const Obstacle& thing, const std::string& name,
                 const Eigen::Isometry2d& world_from_start);
  // Compares the behavior's maps with the true obstacles.
  void watch_map(const std::vector<Obstacle>& obstacles, const Eigen::Isometry2d& world_from_start);
  void look(sim::Simulation& simulation) override;
  // The same for a simulator in another process.
  void look(const Truth& truth);
  void map(const behavior::MapReport& report) override;
  // Call this when the behavior has ended. Later looks are ignored, because its motors go off.
  void end() { ended_ = true; }

  // Whether the trunk was more than 60 degrees from upright at any time. For a robot that lay at first: at
  // the last look.
  bool fell() const;
  // Motion from the first look to the last: along and across the first heading (m), and turned (rad).
  double forward_m() const;
  double aside_m() const;
  double heading_rad() const { return heading_; }
  // Name of the first object on the floor that was touched before any fall; "" if none.
  const std::string& touched() const { return touch_.thing; }
  // Whether the first touched object was still sliding into the way, so that it hit the robot.
  bool was_hit() const { return was_hit_; }
  // Time in s from the robot's first step to the last look; nullopt before it. A step begins when an ankle
  // has risen by sim::kFirstStep. watched_s() counts from the start of the simulation.
  std::optional<double> walked_s() const;
  double watched_s() const { return seconds(last_.time); }
  // Uninterrupted time in s, up to the last look. held_s(): the ball was clear of the floor. upright_s(): the
  // trunk was within 30 degrees of upright, with its origin above 0.11 m.
  double held_s() const { return lasting_s(held_since_); }
  double upright_s() const { return lasting_s(upright_since_); }
  // Share of the last `seconds` during which the left eye's axis was within 3 degrees of the ball.
  double tracked(double seconds) const;
  // Unit vector from the left eye to the ball at the last look, in the trunk's axes.
  std::optional<Eigen::Vector3d> ball_direction() const;
  // Position of the ball from the midpoint of the ankles at the last look; x ahead, y left, m.
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
  std::optional<OwnBody> own_;  // since the first look
  Eigen::Isometry2d start_from_world_ = Eigen::Isometry2d::Identity();
  std::optional<Eigen::Isometry3d> start_;
  Truth last_;
  double heading_ = 0, last_yaw_ = 0;  // rad; the heading counts full turns
  std::optional<Time> held_since_, upright_since_, first_step_;
  double left_foot_m_ = 0, right_foot_m_ = 0;  // heights of the ankles at the first look
  std::vector<Gaze> gazes_;                    // each is valid until the next
};

// Result of an episode, and the claim of its behavior.
struct Verdict {
  bool success = false;
  std::string cause = {};  // reason of the failure; empty for a success
  // Ground truth decides. False: the task is unknown, and the claim counts unless the robot fell.
  bool judged = true;
  bool claim = false;  // the behavior claims success
};
// Decides by ground truth. A robot that fell has failed. Otherwise success requires:
// - search-ball: the reported direction is within 5 degrees of the ball's. It consists of `ball_bearing_deg`
//   (left) and `ball_elevation_deg` (up), from the left eye, in the trunk's axes.
// - track-ball: the left eye's axis is within 3 degrees of the ball for 90 % of the last `seconds` (an
//   option).
// - approach-ball: the ball is within reach of a hand, 100 +- 26 mm ahead of the ankles and 47 +- 27 mm
//   aside.
// - catch-ball: the ball is clear of the floor for the last 3 s.
// - stand, get-up: the trunk is upright and high for the last 3 s.
// - go-forward: the distance is within 10 %, the heading within 8 degrees.
// - turn-left, turn-right: the heading is within 6 degrees of the option `angle`.
// - navigate: no obstacle was touched, and no sliding object hit the robot. The goal is within 5 cm and its
//   heading, if any, within 10 degrees; or the ball is held as for catch-ball.
// A behavior that ended with an error has failed. The cause of a failure is a fall or a touch. Otherwise it
// is the cause that an unsuccessful behavior reports, else the unmet criterion. For other tasks the claim
// decides.
Verdict verdict_of(const Task& task, const Result<behavior::Outcome>& outcome, const Judge& judge);

}  // namespace kaz::tools
