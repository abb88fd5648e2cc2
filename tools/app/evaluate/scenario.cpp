// Draws what differs from episode to episode, and writes the files that make it so.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/evaluate/scenario.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/plan/grid_planner.h"
#include "shared/base/random.hpp"

namespace kaz::tools {
namespace {

using trials::digits;

constexpr double kPi = std::numbers::pi;

// What random numbers are for: each has its own stream.
enum class Draw : std::uint64_t {
  friction = 301,
  supply,
  distance,
  bearing,
  radius,
  color,
  floor,
  mass,
  start_x,
  start_y,
  start_yaw,
  lamp_azimuth,
  lamp_height,
  lamp,
  shade,
  obstacles,
  goal
};

// 0..1, from the normal distribution that is keyed alike on all machines.
double evenly(std::uint64_t seed, Draw what) {
  const double normal = keyed_normal(seed, 0, static_cast<std::uint64_t>(what));
  return std::clamp(0.5 * std::erfc(-normal / std::numbers::sqrt2), 0.0, 1 - 1e-12);
}
double within(const Interval& interval, std::uint64_t seed, Draw what) {
  return interval.min + (interval.max - interval.min) * evenly(seed, what);
}
template <class T>
const T& one_of(const std::vector<T>& all, std::uint64_t seed, Draw what) {
  return all[static_cast<std::size_t>(evenly(seed, what) * static_cast<double>(all.size()))];
}

// A wedge of hue around that of the paint.
vision::ColorRange range_around(const std::array<double, 3>& rgb) {
  const vision::Yiq yiq = vision::yiq_from_rgb(255 * rgb[0], 255 * rgb[1], 255 * rgb[2]);
  const double hue = std::atan2(yiq.q, yiq.i);
  vision::ColorRange range = vision::ColorRange::red_ball();
  range.hue_min = hue - 14 * kPi / 180;
  range.hue_max = hue + 14 * kPi / 180;
  range.saturation_min = std::min(range.saturation_min, 0.5 * std::hypot(yiq.i, yiq.q) / yiq.y);
  return range;
}

// Evenly in 0..1, one after the other.
class Dice {
 public:
  Dice(std::uint64_t seed, Draw what) : seed_(seed), what_(what) {}
  double operator()(double from, double to) {
    const double normal = keyed_normal(seed_, ++number_, static_cast<std::uint64_t>(what_));
    return from +
           (to - from) * std::clamp(0.5 * std::erfc(-normal / std::numbers::sqrt2), 0.0, 1.0);
  }

 private:
  std::uint64_t seed_, number_ = 0;
  Draw what_;
};

// None of a ball's colour: red and green balls are looked for.
constexpr std::array<std::array<double, 3>, 6> kThings{{{0.16, 0.33, 0.70},
                                                        {0.90, 0.76, 0.16},
                                                        {0.42, 0.30, 0.62},
                                                        {0.88, 0.87, 0.84},
                                                        {0.30, 0.28, 0.27},
                                                        {0.55, 0.42, 0.30}}};

Obstacle draw_obstacle(Dice& dice, double reach_m) {
  Obstacle o;
  o.round = dice(0, 1) < 0.3;
  o.length_m = dice(0.06, 0.22);
  o.width_m = o.round ? o.length_m : dice(0.06, 0.22);
  o.height_m = dice(0.05, 0.24);
  o.yaw_rad = dice(-kPi, kPi);
  o.x_m = dice(-0.5, reach_m);
  o.y_m = dice(-reach_m, reach_m);
  o.rgb = kThings[static_cast<std::size_t>(dice(0, 5.999))];
  return o;
}

// m, from a place to the obstacle's wall; 0 inside.
double distance_to(const Obstacle& o, const Eigen::Vector2d& place) {
  const Eigen::Vector2d at =
      Eigen::Rotation2Dd(-o.yaw_rad) * (place - Eigen::Vector2d(o.x_m, o.y_m));
  if (o.round) return std::max(0.0, at.norm() - o.length_m / 2);
  const Eigen::Vector2d beyond =
      (at.cwiseAbs() - Eigen::Vector2d(o.length_m, o.width_m) / 2).cwiseMax(0.0);
  return beyond.norm();
}

// The floor as it truly is.
plan::Grid true_grid(const std::vector<Obstacle>& obstacles, double reach_m) {
  plan::Grid grid;
  grid.cells_x = grid.cells_y = static_cast<int>(std::ceil(2 * reach_m / grid.cell_m));
  grid.corner = {-reach_m, -reach_m};
  grid.state.assign(static_cast<std::size_t>(grid.cells_x) * static_cast<std::size_t>(grid.cells_y),
                    map::CellState::floor);
  for (int x = 0; x < grid.cells_x; ++x) {
    for (int y = 0; y < grid.cells_y; ++y) {
      const Eigen::Vector2d at = grid.middle(x, y);
      if (std::ranges::any_of(obstacles,
                              [&](const Obstacle& o) { return distance_to(o, at) == 0; }))
        grid.state[grid.index(x, y)] = map::CellState::obstacle;
    }
  }
  return grid;
}

std::string thing(const Obstacle& o, std::size_t number, const Scenario& s) {
  const double c = std::cos(s.start_yaw_rad), d = std::sin(s.start_yaw_rad);
  const std::string shape = o.round ? "<cylinder><radius>" + digits(o.length_m / 2) +
                                          "</radius><length>" + digits(o.height_m) +
                                          "</length></cylinder>"
                                    : "<box><size>" + digits(o.length_m) + " " + digits(o.width_m) +
                                          " " + digits(o.height_m) + "</size></box>";
  return "<model name=\"thing" + std::to_string(number) + "\"><static>true</static><pose>" +
         digits(s.start_x_m + c * o.x_m - d * o.y_m) + " " +
         digits(s.start_y_m + d * o.x_m + c * o.y_m) + " " + digits(o.height_m / 2) + " 0 0 " +
         digits(o.yaw_rad + s.start_yaw_rad) +
         "</pose><link name=\"body\"><visual name=\"paint\"><geometry>" + shape +
         "</geometry><material><diffuse>" + digits(o.rgb[0]) + " " + digits(o.rgb[1]) + " " +
         digits(o.rgb[2]) + " 1</diffuse></material></visual><collision name=\"hull\"><geometry>" +
         shape + "</geometry></collision></link></model>\n";
}

std::string ball_of(const Scenario& scenario, const BallColor& color);

// A floor, what stands on it, and a ball of hard rubber.
Result<std::string> world_of(const Scenario& scenario) {
  const auto color = KAZ_TRY(ball_color(scenario.ball_color));
  const Scenario& s = scenario;
  const double aside = std::cos(s.lamp_height_rad);
  std::string things;
  for (std::size_t i = 0; i < s.obstacles.size(); ++i) things += thing(s.obstacles[i], i, s);
  if (s.has_ball) things += ball_of(s, color);
  return R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:kaz="urn:kaz:sdf"><world name="episode">
<kaz:robot pose=")" +
         digits(s.start_x_m) + " " + digits(s.start_y_m) + " 0 0 0 " + digits(s.start_yaw_rad) +
         R"("/><kaz:light to_lamp=")" + digits(aside * std::cos(s.lamp_azimuth_rad)) + " " +
         digits(aside * std::sin(s.lamp_azimuth_rad)) + " " + digits(std::sin(s.lamp_height_rad)) +
         "\" lamp=\"" + digits(s.lamp) + "\" shade=\"" + digits(s.shade) + R"("/>
<model name="floor"><static>true</static><link name="slab"><collision name="hull">
<geometry><plane><normal>0 0 1</normal><size>8 8</size></plane></geometry>
<surface><friction><ode><mu>)" +
         digits(scenario.friction) + R"(</mu></ode></friction></surface></collision>
<visual name="top"><geometry><plane><normal>0 0 1</normal><size>8 8</size></plane></geometry>
<material><diffuse>0.72 0.60 0.44 1</diffuse></material><kaz:texture name=")" +
         scenario.floor + R"("/></visual></link></model>
)" + things +
         "</world></sdf>\n";
}

std::string ball_of(const Scenario& scenario, const BallColor& color) {
  const Scenario& s = scenario;
  const double r = s.ball_radius_m;
  const double c = std::cos(s.start_yaw_rad), d = std::sin(s.start_yaw_rad);
  const double ball_x = s.start_x_m + c * s.ball_x_m - d * s.ball_y_m;
  const double ball_y = s.start_y_m + d * s.ball_x_m + c * s.ball_y_m;
  const double mass = 0.015 * std::pow(r / 0.020, 3);
  const std::string moment = digits(0.4 * mass * r * r);
  return R"(<model name="ball"><pose>)" + digits(ball_x) + " " + digits(ball_y) + " " + digits(r) +
         R"( 0 0 0</pose><link name="ball"><inertial><mass>)" + digits(mass) +
         "</mass><inertia><ixx>" + moment + "</ixx><iyy>" + moment + "</iyy><izz>" + moment +
         R"(</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>
<collision name="skin"><geometry><sphere><radius>)" +
         digits(r) +
         R"(</radius></sphere></geometry><surface><friction><ode><mu>1.0</mu></ode></friction>
<kaz:rolling_resistance metres="0.0005"/></surface></collision>
<visual name="paint"><geometry><sphere><radius>)" +
         digits(r) + "</radius></sphere></geometry><material><diffuse>" + digits(color.rgb[0]) +
         " " + digits(color.rgb[1]) + " " + digits(color.rgb[2]) +
         " 1</diffuse></material></visual></link></model>\n";
}

}  // namespace

std::span<const BallColor> ball_colors() {
  static const std::array<BallColor, 3> all = [] {
    std::array<BallColor, 3> colors{{{"red", {0.85, 0.06, 0.05}, {}},
                                     {"green", {0.08, 0.55, 0.12}, {}},
                                     {"blue", {0.06, 0.16, 0.75}, {}}}};
    for (BallColor& color : colors) color.range = range_around(color.rgb);
    colors[0].range = vision::ColorRange::red_ball();
    return colors;
  }();
  return all;
}

Result<BallColor> ball_color(const std::string& name) {
  std::string names;
  for (const BallColor& color : ball_colors()) {
    if (color.name == name) return color;
    names += (names.empty() ? "" : ", ") + std::string(color.name);
  }
  return fail(Fault::usage, "'" + name + "' is no colour of a ball: there are " + names);
}

Scenario Scenario::draw(const Variation& variation, std::uint64_t seed, std::uint64_t episode) {
  Scenario s;
  // Far enough apart that episodes of neighbouring seeds are not each other's.
  // At most 18 digits, as `kaz sim --seed` takes them.
  s.seed = (seed * 1'000'003 + episode + 1) % 1'000'000'000'000'000'000u;
  s.friction = within(variation.friction, s.seed, Draw::friction);
  s.supply_volts = within(variation.supply_volts, s.seed, Draw::supply);
  const double distance = within(variation.ball_distance_m, s.seed, Draw::distance);
  const double max_bearing = variation.bearing_deg * kPi / 180;
  const double bearing = within({-max_bearing, max_bearing}, s.seed, Draw::bearing);
  s.ball_x_m = distance * std::cos(bearing);
  s.ball_y_m = distance * std::sin(bearing);
  s.ball_radius_m = one_of(variation.radii_m, s.seed, Draw::radius);
  s.ball_color = one_of(variation.colors, s.seed, Draw::color);
  s.floor = one_of(std::vector<std::string>{"wood", "carpet", "checker"}, s.seed, Draw::floor);
  s.mass_sigma = variation.mass_sigma;
  s.start_x_m = within({-0.5, 0.5}, s.seed, Draw::start_x);
  s.start_y_m = within({-0.5, 0.5}, s.seed, Draw::start_y);
  s.start_yaw_rad = within({-kPi, kPi}, s.seed, Draw::start_yaw);
  s.lamp_azimuth_rad = within({-kPi, kPi}, s.seed, Draw::lamp_azimuth);
  s.lamp_height_rad = within(variation.lamp_height_deg, s.seed, Draw::lamp_height) * kPi / 180;
  s.lamp = within(variation.lamp, s.seed, Draw::lamp);
  s.shade = within(variation.shade, s.seed, Draw::shade);
  return s;
}

Result<void> Scenario::add_obstacles(const Variation& variation, bool ball_is_goal) {
  has_ball = ball_is_goal;
  constexpr double kStartFree = 0.28, kGoalFree = 0.24;  // m, around them
  plan::PlanOptions options;
  options.radius_m =
      0.20;  // wider than the robot plans for itself: what it may think impassable is not drawn
  const auto planner = plan::make_grid_planner();
  for (std::uint64_t draw = 0; draw < 100; ++draw) {
    Dice dice(seed + draw * 7919, Draw::obstacles), aim(seed + draw * 7919, Draw::goal);
    const double bearing = variation.bearing_deg * kPi / 180 * aim(-1, 1);
    const double distance = aim(variation.goal_distance_m.min, variation.goal_distance_m.max);
    goal_has_heading = aim(0, 1) < 0.5 && !ball_is_goal;
    goal_heading_rad = aim(-kPi, kPi);
    goal_x_m = ball_is_goal ? ball_x_m : distance * std::cos(bearing);
    goal_y_m = ball_is_goal ? ball_y_m : distance * std::sin(bearing);
    const Eigen::Vector2d goal(goal_x_m, goal_y_m);
    obstacles.clear();
    const int most = variation.max_obstacles;
    const auto count = static_cast<std::size_t>(dice((most + 1) / 2, most + 0.999));
    const double reach = goal.norm() + 0.4;
    while (obstacles.size() < count) {
      const Obstacle o = draw_obstacle(dice, reach);
      if (distance_to(o, {0, 0}) > kStartFree && distance_to(o, goal) > kGoalFree)
        obstacles.push_back(o);
    }
    plan::Goal wanted{goal, {}};
    if (goal_has_heading) wanted.heading_rad = goal_heading_rad;
    const plan::Grid grid = true_grid(obstacles, reach + 0.4);
    const auto way = KAZ_TRY(planner->plan(grid, {}, wanted, options));
    if (!std::holds_alternative<plan::Path>(way)) continue;
    options.radius_m = plan::PlanOptions{}.radius_m;
    const auto least = KAZ_TRY(planner->plan(grid, {}, wanted, options));
    least_s = std::get<plan::Path>(least).seconds;
    return {};
  }
  return fail(Fault::usage, "a hundred draws of obstacles left no way to the goal: ask for fewer");
}

nlohmann::ordered_json scenario_json(const Scenario& s) {
  nlohmann::ordered_json json{{"seed", s.seed},
                              {"friction", s.friction},
                              {"supply_volts", s.supply_volts},
                              {"ball_m", {s.ball_x_m, s.ball_y_m}},
                              {"ball_radius_m", s.ball_radius_m},
                              {"ball_color", s.ball_color},
                              {"floor", s.floor},
                              {"start", {s.start_x_m, s.start_y_m, s.start_yaw_rad}},
                              {"lamp_azimuth_rad", s.lamp_azimuth_rad},
                              {"lamp_height_rad", s.lamp_height_rad},
                              {"lamp", s.lamp},
                              {"shade", s.shade}};
  if (s.least_s > 0) {
    json["obstacles"] = s.obstacles.size();
    json["goal_m"] = {s.goal_x_m, s.goal_y_m};
    if (s.goal_has_heading) json["goal_heading_rad"] = s.goal_heading_rad;
    json["least_s"] = s.least_s;
  }
  return json;
}

Result<trials::RobotFolder> scenario_files(const Scenario& scenario, const std::string& robot) {
  const auto world = KAZ_TRY(world_of(scenario));
  const auto factor = [&](std::uint64_t number) {
    return 1 + scenario.mass_sigma *
                   keyed_normal(scenario.seed, number, static_cast<std::uint64_t>(Draw::mass));
  };
  return trials::RobotFolder::make(
      robot,
      {{"kaz.urdf", [&](const std::string& urdf) { return trials::with_masses(urdf, factor); }}},
      world);
}

}  // namespace kaz::tools
