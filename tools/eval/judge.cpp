// Watches what the robot touches and where it goes, and decides.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/judge.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/base/angle.hpp"
#include "shared/base/number_text.hpp"
#include "sim/body/world/world.h"
#include "sim/runtime/simulation/simulation.h"
#include "tools/eval/scenario.h"

namespace kaz::tools {

using behavior::Criterion;

namespace {

constexpr double kGoal_m = 0.05, kGoalHeading = 10 * kDegree;
constexpr double kLasting_s = 3;
constexpr double kFound = 5 * kDegree, kTrackedShare = 0.9;
// Where a ball lies before a hand, m from the ankles' midpoint: ahead, to either side, and how far off.
constexpr double kReachAhead_m = 0.100, kReachAside_m = 0.047;
constexpr double kReachOffAhead_m = 0.026, kReachOffAside_m = 0.027;
constexpr double kDistanceShare = 0.1, kWalkHeading = 8 * kDegree, kTurned = 6 * kDegree;

std::optional<Eigen::Isometry3d> pose_of(const sim::World& world, const char* link) {
  const auto links = world.link_order();
  if (std::ranges::find(links, link) == links.end()) return std::nullopt;
  return world.link_pose(link);
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
                  Eigen::Translation2d(forward_m(), aside_m()) * Eigen::Rotation2Dd(heading_rad()));
  if (way_) way_->plan(report.time, report.path);
}

void Judge::look(sim::Simulation& simulation) {
  if (ended_) return;
  sim::World& world = simulation.world();
  if (options_.watches_touch && !body_.started()) world.watch_contacts(true);
  Truth truth{.time = simulation.time(),
              .trunk = world.link_pose("trunk"),
              .left_foot = pose_of(world, "l_ankle_pitch"),
              .right_foot = pose_of(world, "r_ankle_pitch")};
  if (simulation.has_eyes()) truth.left_eye = world.link_pose("left_eye");
  if (world.measures_convergence()) truth.unconverged_steps = world.diagnostics().unconverged_steps;
  if (options_.watches_touch && touch_.thing.empty()) truth.touch = touch_now(world);
  truth.touch.at_s = seconds(truth.time);
  if (way_) {
    if (const auto thing = world.object_position(way_->name()); thing)
      truth.moving = thing->head<2>();
  }
  if (const auto ball = world.object_position("ball"); ball) truth.ball = *ball;
  if (map_ && simulation.has_eyes() && map_->looks_at(truth.time)) look_at_outlines(simulation);
  look(truth);
}

void Judge::look_at_outlines(sim::Simulation& simulation) {
  const sim::World& world = simulation.world();
  // The eyes draw the same files: they can be read.
  if (!own_) own_ = OwnBody::make(world.scene(), world.link_order()).value();
  Eigen::Isometry3d start_from_world = Eigen::Isometry3d::Identity();
  start_from_world.linear().topLeftCorner<2, 2>() = start_from_world_.linear();
  start_from_world.translation().head<2>() = start_from_world_.translation();
  own_->move(world.pose(), start_from_world);
  map_->look(simulation.time(), start_from_world * world.link_pose("left_eye"),
             simulation.camera().model(), &*own_);
}

void Judge::look(const Truth& truth) {
  if (ended_) return;
  last_ = truth;
  body_.look(truth);
  ball_.look(truth);
  // What a falling robot touches is not why it failed.
  if (touch_.thing.empty() && !truth.touch.thing.empty() && body_.upright()) {
    touch_ = truth.touch;
    was_hit_ = way_ && touch_.thing == way_->name() && !way_->arrived();
  }
  if (way_ && truth.moving)
    way_->look(truth.time, start_from_world_ * *truth.moving,
               start_from_world_ * Eigen::Vector2d(truth.trunk.translation().head<2>()));
}

std::optional<double> Judge::walked_s() const {
  if (!body_.first_step()) return std::nullopt;
  return seconds(last_.time - *body_.first_step());
}

std::optional<Eigen::Vector3d> Judge::ball_direction() const {
  if (!last_.ball || !last_.left_eye) return std::nullopt;
  return (last_.trunk.linear().transpose() * (*last_.ball - last_.left_eye->translation()))
      .normalized();
}

std::optional<Eigen::Vector2d> Judge::ball_from_feet_m() const {
  if (!last_.ball || !last_.left_foot || !last_.right_foot) return std::nullopt;
  const Eigen::Vector3d middle =
      (last_.left_foot->translation() + last_.right_foot->translation()) / 2;
  const Eigen::Vector2d ahead =
      (last_.left_foot->linear().col(0) + last_.right_foot->linear().col(0)).head<2>().normalized();
  const Eigen::Vector2d off = (*last_.ball - middle).head<2>();
  return Eigen::Vector2d(off.dot(ahead), ahead.x() * off.y() - ahead.y() * off.x());
}

nlohmann::ordered_json Judge::json() const {
  if (!body_.started()) return nlohmann::ordered_json::object();  // nothing was seen
  nlohmann::ordered_json json{{"fell", fell()},
                              {"upright_s", upright_s()},
                              {"forward_m", forward_m()},
                              {"aside_m", aside_m()},
                              {"heading_deg", heading_rad() / kDegree}};
  if (!touched().empty())
    json["touched"] = {{"thing", touch_.thing}, {"by", touch_.by}, {"at_s", touch_.at_s}};
  if (way_) json["moving"] = way_->json();
  if (map_) json["map"] = map_->json();
  if (last_.unconverged_steps) json["unconverged_steps"] = *last_.unconverged_steps;
  if (!last_.ball) return json;
  json["held_s"] = held_s();
  json["ball_m"] = {last_.ball->x(), last_.ball->y(), last_.ball->z()};
  if (const auto ray = ball_direction()) {
    json["ball_bearing_deg"] = std::atan2(ray->y(), ray->x()) / kDegree;
    json["ball_elevation_deg"] = std::asin(std::clamp(ray->z(), -1.0, 1.0)) / kDegree;
  }
  if (const auto ball = ball_from_feet_m()) json["ball_from_feet_m"] = {ball->x(), ball->y()};
  return json;
}

namespace {

// "X,Y", "X,Y,DEGREES" or "ball".
bool read_goal(const std::string& text, Task& task) {
  if (text == "ball") return task.ball = true;
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto number = parse_number<double>(std::string_view(text).substr(begin, end - begin));
    if (!number) return false;
    numbers.push_back(*number);
    begin = end + 1;
  }
  if (numbers.size() < 2 || numbers.size() > 3) return false;
  task.goal = {numbers[0], numbers[1]};
  if (numbers.size() == 3) task.goal_heading_rad = numbers[2] * kDegree;
  return true;
}

std::string not_held(const Judge& judge) {
  return judge.held_s() >= kLasting_s ? "" : "not held";
}

// Where it went, against the goal; empty if it is there.
std::string missed_goal(const Task& task, const Judge& judge) {
  if (task.ball) return not_held(judge);
  const Eigen::Vector2d at(judge.forward_m(), judge.aside_m());
  if ((at - task.goal).norm() > kGoal_m) return "beside the goal";
  if (!task.goal_heading_rad) return {};
  const double off =
      std::remainder(judge.heading_rad() - *task.goal_heading_rad, 2 * std::numbers::pi);
  return std::abs(off) > kGoalHeading ? "heading" : "";
}

std::optional<double> measured(const Result<behavior::Outcome>& outcome, std::string_view name) {
  if (!outcome) return std::nullopt;
  for (const auto& [its, value] : outcome->measurements)
    if (its == name) return value;
  return std::nullopt;
}

std::string wrong_direction(const Result<behavior::Outcome>& outcome, const Judge& judge) {
  const auto bearing = measured(outcome, "ball_bearing_deg"),
             elevation = measured(outcome, "ball_elevation_deg");
  const auto truth = judge.ball_direction();
  if (!bearing || !elevation || !truth) return "no direction";
  const double b = *bearing * kDegree, e = *elevation * kDegree;
  const Eigen::Vector3d reported(std::cos(e) * std::cos(b), std::cos(e) * std::sin(b), std::sin(e));
  return angle_between(reported, *truth) <= kFound ? "" : "wrong direction";
}

std::string out_of_reach(const Judge& judge) {
  const auto ball = judge.ball_from_feet_m();
  const bool in_reach = ball && std::abs(ball->x() - kReachAhead_m) <= kReachOffAhead_m &&
                        std::abs(std::abs(ball->y()) - kReachAside_m) <= kReachOffAside_m;
  return in_reach ? "" : "out of reach";
}

std::string missed_turn(const Task& task, const Judge& judge) {
  return std::abs(judge.heading_rad() - task.angle_rad) > kTurned ? "heading" : "";
}

std::string missed_walk(const Task& task, const Judge& judge) {
  const double off = judge.forward_m() - task.distance_m;
  if (std::abs(off) > kDistanceShare * std::abs(task.distance_m)) return "distance";
  return std::abs(judge.heading_rad()) > kWalkHeading ? "heading" : "";
}

// Why ground truth does not meet the criterion; empty: it does.
std::string unmet(const Task& task, const Result<behavior::Outcome>& claim, const Judge& judge) {
  switch (task.criterion) {
    case Criterion::claim:
      return "";
    case Criterion::ball_direction:
      return wrong_direction(claim, judge);
    case Criterion::ball_tracked:
      return judge.tracked(task.seconds) >= kTrackedShare ? "" : "off the ball";
    case Criterion::ball_in_reach:
      return out_of_reach(judge);
    case Criterion::ball_held:
      return not_held(judge);
    case Criterion::upright:
      return judge.upright_s() >= kLasting_s ? "" : "not upright";
    case Criterion::walked:
      return missed_walk(task, judge);
    case Criterion::turned_left:
    case Criterion::turned_right:
      return missed_turn(task, judge);
    case Criterion::at_goal:
      return missed_goal(task, judge);
  }
  return "";
}

}  // namespace

Result<Task> task_of(const behavior::Behavior& judged, const behavior::OptionValues& options) {
  Task task{.criterion = judged.evaluation.criterion};
  try {
    if (task.criterion == Criterion::walked) task.distance_m = options.number("distance");
    if (task.criterion == Criterion::ball_tracked) task.seconds = options.number("seconds");
    if (task.criterion == Criterion::turned_left)
      task.angle_rad = options.number("angle") * kDegree;
    if (task.criterion == Criterion::turned_right)
      task.angle_rad = -options.number("angle") * kDegree;
    if (task.criterion == Criterion::at_goal && !read_goal(options.choice("goal"), task))
      return fail(Fault::usage, "goal '" + options.choice("goal") +
                                    "' cannot be judged: give X,Y or X,Y,DEGREES or ball");
  } catch (const std::out_of_range& lacking) {
    return fail(Fault::usage, "the behavior cannot be judged as " + std::string(judged.name) +
                                  ": " + lacking.what());
  }
  return task;
}

EpisodeVerdict verdict_of(const Task& task, const Result<behavior::Outcome>& outcome,
                          const Judge& judge) {
  EpisodeVerdict verdict{.judged = task.judged(), .claim = outcome && outcome->success};
  const auto failed = [&verdict](const std::string& cause) {
    verdict.cause = cause;
    return verdict;
  };
  if (task.criterion == Criterion::at_goal && !judge.touched().empty())
    return failed(judge.was_hit() ? "hit by a moving box" : "touched");
  if (judge.fell()) return failed(judge.lay() ? "lies" : "fell");
  if (!outcome) return failed("error");
  const std::string named = outcome->success         ? ""
                            : outcome->cause.empty() ? "gave up"
                                                     : outcome->cause;
  const std::string lacking =
      named == "error" || !task.judged() ? named : unmet(task, outcome, judge);
  if (!lacking.empty()) return failed(named.empty() ? lacking : named);
  verdict.success = true;
  return verdict;
}

}  // namespace kaz::tools
