// Ground truth of an episode, and the tracks of robot and ball that the judge derives from the ground truth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/time.hpp"

namespace kaz::tools {

// Height of a ball's lowest point above which the ball counts as lifted.
constexpr double kClearOfFloor_m = 0.02;

// Ground truth at one time, in the world frame; m.
struct Truth {
  Time time{};
  Eigen::Isometry3d trunk = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Vector3d> ball = {};
  std::optional<Eigen::Isometry3d> left_eye = {};  // optical frame: x right, y down, z forward
  // Frames at the ankles, x ahead.
  std::optional<Eigen::Isometry3d> left_foot = {}, right_foot = {};
  struct Touch {
    // `thing`: model of the touched object; "" without contact. `by`: link of the robot that touches the
    // object.
    std::string thing, by;
    double at_s = 0;
  };
  Touch touch = {};                            // contact with an object that stands on the floor
  std::optional<Eigen::Vector2d> moving = {};  // position of the object given to watch_way()
  std::optional<std::int64_t> unconverged_steps = {};
};

// Angle between directions, rad.
double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

// Motion of the robot's trunk and ankles from the first look to the last.
class BodyTrack {
 public:
  void look(const Truth& truth);

  bool started() const { return start_.has_value(); }  // after the first look
  bool upright() const;  // whether the trunk was within 30 degrees of upright at the last look
  bool lies() const;     // whether the trunk was more than 60 degrees from upright at the last look
  bool has_lain() const { return has_lain_; }  // the same at any look
  // Distances along and across the first heading, m, and the turned angle, rad, including full turns. All
  // are 0 before the first look.
  double forward_m() const;
  double aside_m() const;
  double heading_rad() const { return heading_; }
  // Time at which an ankle first was more than sim::kFirstStep above its height at the first look.
  const std::optional<Time>& first_step() const { return first_step_; }
  // Time since which the trunk is upright with its origin above 0.11 m; nullopt if it is not.
  const std::optional<Time>& upright_since() const { return upright_since_; }

 private:
  std::optional<Eigen::Isometry3d> start_;
  Eigen::Isometry3d trunk_ = Eigen::Isometry3d::Identity();
  double heading_ = 0, last_yaw_ = 0;
  bool has_lain_ = false;
  double left_foot_m_ = 0, right_foot_m_ = 0;  // heights of the ankles at the first look
  std::optional<Time> first_step_, upright_since_;
};

// Where the ball was, and when the left eye was directed at it.
class BallTrack {
 public:
  explicit BallTrack(double radius_m) : radius_m_(radius_m) {}
  void look(const Truth& truth);

  // Time since which the ball is clear of the floor; nullopt if it is not.
  const std::optional<Time>& held_since() const { return held_since_; }
  // Returns the share (0 to 1) of the last `seconds_before` until `end` during which the left eye's axis was
  // within 3 degrees of the ball.
  double tracked(Time end, double seconds_before) const;

 private:
  // Valid until the time of the next entry.
  struct Gaze {
    Time time{};
    bool near = false;  // the axis of the eye is within 3 degrees of the ball
  };
  double radius_m_;
  std::optional<Time> held_since_;
  std::vector<Gaze> gazes_;
};

}  // namespace kaz::tools
