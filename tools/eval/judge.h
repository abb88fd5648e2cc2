// Decides from the simulator's ground truth how an episode ended.
// SPDX-License-Identifier: Apache-2.0
//
// Ground truth alone decides success. A behavior's claim of success is compared with the ground truth, but
// does not decide. Only one reported value is judged: the direction that search-ball reports. The judge uses
// its own bounds and formulas, and no code of a behavior.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "tools/eval/judge_tracks.h"
#include "tools/eval/map_truth.h"
#include "tools/eval/way_watch.h"
#include "tools/run/run_observer.h"

namespace kaz::tools {

// Goal of an episode: the criterion of its behavior, and the options that the criterion needs.
struct Task {
  behavior::Criterion criterion = behavior::Criterion::claim;
  double distance_m = 0;  // for walked
  double angle_rad = 0;   // for turned_left and turned_right; positive to the left
  double seconds = 0;     // for ball_tracked
  bool ball = false;      // for at_goal: the robot must hold the ball
  // For at_goal without ball: goal in m in the frame of the start, x ahead.
  Eigen::Vector2d goal{0, 0};
  std::optional<double> goal_heading_rad = {};

  // Returns whether ground truth decides success.
  bool judged() const { return criterion != behavior::Criterion::claim; }
};
// Returns the task of a behavior that is judged as `judged`. Fails (usage) if `options` lacks an option that
// the criterion needs.
Result<Task> task_of(const behavior::Behavior& judged, const behavior::OptionValues& options);

struct JudgeOptions {
  double ball_radius_m = 0.020;
  bool watches_touch = false;  // records the first touch for touched(), which costs computing time
  bool lies = false;           // the robot lies on the floor at the start and must get up
};

class Judge final : public RunObserver {
 public:
  explicit Judge(const JudgeOptions& options) : options_(options), ball_(options.ball_radius_m) {}
  // Watches the obstacle `thing`, which slides into the robot's way. `name`: model name of the obstacle.
  // `world_from_start`: pose in the world of the frame in which `thing` is given.
  void watch_way(const Obstacle& thing, const std::string& name,
                 const Eigen::Isometry2d& world_from_start);
  // Compares the behavior's maps with the true obstacles.
  void watch_map(const std::vector<Obstacle>& obstacles, const Eigen::Isometry2d& world_from_start);
  void look(sim::Simulation& simulation) override;
  // Like the function above, for a simulator in another process.
  void look(const Truth& truth);
  void map(const behavior::MapReport& report) override;
  // Later calls of look() are ignored, because the motors are switched off at the end of the behavior.
  void ended(const Result<behavior::Outcome>&, double, double) override { end(); }
  // Like ended(), for a behavior in another process.
  void end() { ended_ = true; }

  // Returns whether the trunk was more than 60 degrees from upright at any time. For a robot that lay at the
  // start, only the last look counts.
  bool fell() const { return options_.lies ? body_.lies() : body_.has_lain(); }
  // Motion of the robot from the first look to the last. forward_m() and aside_m(): distances along and
  // across the first heading, m. heading_rad(): turned angle.
  double forward_m() const { return body_.forward_m(); }
  double aside_m() const { return body_.aside_m(); }
  double heading_rad() const { return body_.heading_rad(); }
  // Returns the name of the first object on the floor that the robot touched before a fall; "" if there was
  // no touch.
  const std::string& touched() const { return touch_.thing; }
  // Returns whether the robot lay on the floor at the start.
  bool lay() const { return options_.lies; }
  // Returns whether the first touched object was still sliding into the robot's way at the time of the touch.
  // In this case the object hit the robot.
  bool was_hit() const { return was_hit_; }
  // walked_s() returns the time in s from the robot's first step to the last look; nullopt before the first
  // step. A step begins when an ankle has risen by sim::kFirstStep. watched_s() returns the time in s from
  // the start of the simulation to the last look.
  std::optional<double> walked_s() const;
  double watched_s() const { return seconds(last_.time); }
  // Time in s, up to the last look, during which a condition was true without interruption. held_s(): the
  // ball was clear of the floor. upright_s(): the trunk was within 30 degrees of upright, and the trunk's
  // origin above 0.11 m.
  double held_s() const { return lasting_s(ball_.held_since()); }
  double upright_s() const { return lasting_s(body_.upright_since()); }
  // Returns the share (0 to 1) of the last `seconds` during which the left eye's axis was within 3 degrees of
  // the ball.
  double tracked(double seconds) const { return ball_.tracked(last_.time, seconds); }
  // Returns the unit vector from the left eye to the ball at the last look, in the trunk's axes.
  std::optional<Eigen::Vector3d> ball_direction() const;
  // Returns the position of the ball relative to the midpoint of the ankles at the last look; x ahead, y
  // left, m.
  std::optional<Eigen::Vector2d> ball_from_feet_m() const;
  nlohmann::ordered_json json() const;

 private:
  void look_at_outlines(sim::Simulation& simulation);
  double lasting_s(const std::optional<Time>& since) const {
    return since ? seconds(last_.time - *since) : 0;
  }

  JudgeOptions options_;
  bool ended_ = false;
  Truth last_;
  BodyTrack body_;
  BallTrack ball_;
  Truth::Touch touch_;
  bool was_hit_ = false;
  std::optional<WayWatch> way_;
  std::optional<MapTruth> map_;
  std::optional<OwnBody> own_;  // set at the first look
  Eigen::Isometry2d start_from_world_ = Eigen::Isometry2d::Identity();
};

// Result of an episode, and the claim of the behavior.
struct EpisodeVerdict {
  bool success = false;
  std::string cause = {};  // reason of the failure; empty for a success
  // True: ground truth decided. False: the criterion is `claim`, so the claim decided unless it fell.
  bool judged = true;
  bool claim = false;  // whether the behavior claims success
};
// Decides by ground truth. A robot that fell has failed. Otherwise success requires:
// - claim: the behavior claims success.
// - ball_direction: the reported direction is within 5 degrees of the true direction of the ball. The
//   reported direction consists of `ball_bearing_deg` (positive to the left) and `ball_elevation_deg`
//   (positive up), from the left eye, in the trunk's axes.
// - ball_tracked: the left eye's axis is within 3 degrees of the ball for 90 % of the last seconds. The
//   option `seconds` sets this time.
// - ball_in_reach: the ball is within reach of a hand, 100 +- 26 mm ahead of the ankles and 47 +- 27 mm to
//   the side.
// - ball_held: the ball is clear of the floor for the last 3 s.
// - upright: the trunk is upright, and high enough (upright_s()), for the last 3 s.
// - walked: the distance along the first heading is within 10 % of the option `distance`. The final
//   heading is within 8 degrees of the first heading.
// - turned_left, turned_right: the turned angle is within 6 degrees of the option `angle`.
// - at_goal: no obstacle was touched, and no sliding object hit the robot. The robot is within 5 cm of the
//   goal. If the goal has a heading, the robot's heading is within 10 degrees of the goal's heading. If the
//   ball is the goal, the ball is held as for ball_held.
// A behavior that ended with an error has failed. If the robot fell or touched an obstacle, the fall or the
// touch is the cause of the failure. Otherwise, the cause that the behavior reports is used. If the behavior
// claims success, the cause is the unmet criterion.
EpisodeVerdict verdict_of(const Task& task, const Result<behavior::Outcome>& outcome,
                          const Judge& judge);

}  // namespace kaz::tools
