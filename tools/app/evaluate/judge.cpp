// Looks at trunk and ball, and decides.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/evaluate/judge.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/behavior/navigation_goal.h"
#include "shared/base/angle.hpp"
#include "tools/app/evaluate/scenario.h"

namespace kaz::tools {
namespace {

constexpr double kGoal_m = 0.05, kGoalHeading = 10 * kDegree;
constexpr double kUpright = 30 * kDegree;  // of the trunk; in the crouch it leans less

double yaw_of(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d ahead = pose.linear().col(0);
  return std::atan2(ahead.y(), ahead.x());
}

// Where it went, against the goal; empty if it is there.
std::string missed_goal(const behavior::NavigationGoal& goal, const Judge& judge) {
  if (goal.ball) return judge.held_s() < 3 ? "not held" : "";
  const Eigen::Vector2d at(judge.forward_m(), judge.aside_m());
  if ((at - goal.position).norm() > kGoal_m) return "beside the goal";
  if (!goal.heading_rad) return {};
  const double off = std::remainder(judge.heading_rad() - *goal.heading_rad, 2 * std::numbers::pi);
  return std::abs(off) > kGoalHeading ? "heading" : "";
}

// Names of a world's links have "::" or, where a model has one link, its name; those of the robot are of its
// URDF.
Truth::Touch touch_now(const sim::World& world) {
  const auto links = world.link_order();
  for (const sim::ContactPoint& contact : world.contacts()) {
    for (const auto& [thing, by] : {std::pair{contact.a, contact.b}, {contact.b, contact.a}}) {
      const bool robot = std::ranges::find(links, by) != links.end();
      if (robot && thing.starts_with(kObstacleName)) return {thing, by, 0};
    }
  }
  return {};
}

}  // namespace

void Judge::watch_way(const Obstacle& thing, const std::string& name,
                      const Eigen::Isometry2d& world_from_start) {
  way_.emplace(thing, name);
  start_from_world_ = world_from_start.inverse();
}

void Judge::watch_map(const std::vector<Obstacle>& obstacles,
                      const Eigen::Isometry2d& world_from_start) {
  map_.emplace(obstacles);
  start_from_world_ = world_from_start.inverse();
}

void Judge::map(const behavior::MapReport& report) {
  if (map_)
    map_->compare(report,
                  Eigen::Translation2d(forward_m(), aside_m()) * Eigen::Rotation2Dd(heading_));
  if (way_) way_->plan(report.time, report.path);
}

void Judge::look(sim::Simulation& simulation) {
  sim::World& world = simulation.world();
  if (watches_touch_ && !start_) world.watch_contacts(true);
  Truth truth{.time = simulation.time(), .trunk = world.link_pose("trunk")};
  if (world.measures_convergence()) truth.unconverged_steps = world.diagnostics().unconverged_steps;
  if (watches_touch_ && touch_.thing.empty()) truth.touch = touch_now(world);
  truth.touch.at_s = seconds(truth.time);
  if (way_) {
    if (const auto thing = world.object_position(way_->name()); thing)
      truth.moving = thing->head<2>();
  }
  if (const auto ball = world.object_position("ball"); ball) truth.ball = *ball;
  if (map_ && simulation.has_eyes()) {
    Eigen::Isometry3d start_from_world = Eigen::Isometry3d::Identity();
    start_from_world.linear().topLeftCorner<2, 2>() = start_from_world_.linear();
    start_from_world.translation().head<2>() = start_from_world_.translation();
    map_->look(truth.time, start_from_world * world.link_pose("left_eye"),
               simulation.camera().model());
  }
  look(truth);
}

void Judge::look(const Truth& truth) {
  now_ = truth.time;
  last_ = truth.trunk;
  unconverged_steps_ = truth.unconverged_steps;
  if (!start_) {
    start_ = last_;
    last_yaw_ = yaw_of(last_);
  }
  // What a falling robot touches is not why it failed.
  const bool upright = last_.linear()(2, 2) > std::cos(kUpright);
  if (touch_.thing.empty() && !truth.touch.thing.empty() && upright) {
    touch_ = truth.touch;
    was_hit_ = way_ && touch_.thing == way_->name() && !way_->arrived();
  }
  if (way_ && truth.moving)
    way_->look(now_, start_from_world_ * *truth.moving,
               start_from_world_ * Eigen::Vector2d(last_.translation().head<2>()));
  heading_ += std::remainder(yaw_of(last_) - last_yaw_, 2 * std::numbers::pi);
  last_yaw_ = yaw_of(last_);
  if (last_.linear()(2, 2) < std::cos(60 * kDegree)) fell_ = true;
  has_ball_ = truth.ball.has_value();
  if (!truth.ball) return;
  ball_ = *truth.ball;
  if (ball_.z() < ball_radius_m_ + kClearOfFloor_m) {
    lifted_.reset();
  } else if (!lifted_) {
    lifted_ = now_;
  }
  if (lifted_) longest_held_s_ = std::max(longest_held_s_, seconds(now_ - *lifted_));
}

double Judge::forward_m() const {
  return start_ ? (start_->inverse() * last_.translation()).x() : 0;
}
double Judge::aside_m() const {
  return start_ ? (start_->inverse() * last_.translation()).y() : 0;
}
double Judge::held_s() const {
  if (!sees_end_) return longest_held_s_;
  return lifted_ ? seconds(now_ - *lifted_) : 0;
}

nlohmann::ordered_json Judge::json() const {
  if (!start_) return nlohmann::ordered_json::object();  // nothing was seen
  nlohmann::ordered_json json{{"fell", fell_},
                              {"forward_m", forward_m()},
                              {"aside_m", aside_m()},
                              {"heading_deg", heading_ / kDegree}};
  if (!touched().empty())
    json["touched"] = {{"thing", touch_.thing}, {"by", touch_.by}, {"at_s", touch_.at_s}};
  if (way_) json["moving"] = way_->json();
  if (map_) json["map"] = map_->json();
  if (unconverged_steps_) json["unconverged_steps"] = *unconverged_steps_;
  if (!has_ball_) return json;
  json["held_s"] = held_s();
  json["ball_m"] = {ball_.x(), ball_.y(), ball_.z()};
  return json;
}

std::string cause_of_failure(const std::string& behavior, const behavior::OptionValues& options,
                             const Result<behavior::Outcome>& outcome, const Judge& judge) {
  if (behavior == "navigate" && !judge.touched().empty())
    return judge.was_hit() ? "hit by a moving box" : "touched";
  if (judge.fell()) return "fell";
  if (!outcome) return "error";
  if (!outcome->success) return outcome->cause.empty() ? "gave up" : outcome->cause;
  if (behavior == "catch-ball" && judge.held_s() < 3) return "not held";
  if (behavior == "navigate")
    return missed_goal(*behavior::navigation_goal(options.choice("goal")), judge);
  if (behavior == "go-forward") {
    const double distance = options.number("distance");
    if (std::abs(judge.forward_m() - distance) > 0.1 * distance) return "distance";
    if (std::abs(judge.heading_rad()) > 8 * kDegree) return "heading";
  }
  if (behavior == "turn-left" || behavior == "turn-right") {
    const double angle = options.number("angle") * (behavior == "turn-left" ? 1 : -1) * kDegree;
    if (std::abs(judge.heading_rad() - angle) > 6 * kDegree) return "heading";
  }
  return {};
}

}  // namespace kaz::tools
