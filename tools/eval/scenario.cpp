// Draws what differs from episode to episode, and writes the files that make it so.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scenario.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/base/random.hpp"
#include "tools/eval/dice.h"

namespace kaz::tools {
namespace {

constexpr double kPi = std::numbers::pi;

// 0 to less than 1.
double evenly(std::uint64_t seed, Draw what) {
  return std::min(from_normal(keyed_normal(seed, 0, static_cast<std::uint64_t>(what))), 1 - 1e-12);
}
double within(const Interval& interval, std::uint64_t seed, Draw what) {
  return interval.min + (interval.max - interval.min) * evenly(seed, what);
}
template <class T>
const T& one_of(const std::vector<T>& all, std::uint64_t seed, Draw what) {
  return all[static_cast<std::size_t>(evenly(seed, what) * static_cast<double>(all.size()))];
}

}  // namespace

std::span<const BallColor> ball_colors() {
  static constexpr std::array<BallColor, 3> all{
      {{"red", {0.85, 0.06, 0.05}}, {"green", {0.08, 0.55, 0.12}}, {"blue", {0.06, 0.16, 0.75}}}};
  return all;
}

std::span<const char* const> floor_names() {
  static constexpr const char* kNames[] = {"wood", "carpet", "checker", "plain"};
  return kNames;
}

Result<BallColor> ball_color(const std::string& name) {
  std::string names;
  for (const BallColor& color : ball_colors()) {
    if (color.name == name) return color;
    names += (names.empty() ? "" : ", ") + std::string(color.name);
  }
  return fail(Fault::usage, "'" + name + "' is not a ball color: use one of " + names);
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
  s.floor = one_of(variation.floors, s.seed, Draw::floor);
  s.mass_sigma = variation.mass_sigma;
  s.kind = variation.worlds[episode % variation.worlds.size()];
  s.start_x_m = within({-0.5, 0.5}, s.seed, Draw::start_x);
  s.start_y_m = within({-0.5, 0.5}, s.seed, Draw::start_y);
  s.start_yaw_rad = within({-kPi, kPi}, s.seed, Draw::start_yaw);
  s.lamp_azimuth_rad = within({-kPi, kPi}, s.seed, Draw::lamp_azimuth);
  s.lamp_height_rad = within(variation.lamp_height_deg, s.seed, Draw::lamp_height) * kPi / 180;
  s.lamp = within(variation.lamp, s.seed, Draw::lamp);
  s.shade = within(variation.shade, s.seed, Draw::shade);
  if (variation.pushes.impulse_ns > 0) s.draw_pushes(variation.pushes);
  return s;
}

void Scenario::draw_pushes(const Pushes& by) {
  constexpr double kLast_s = 600;  // no behavior walks longer
  pushes_from_first_step = by.from_first_step;
  Dice dice(seed, Draw::pushes);
  const auto direction = [&] {
    switch (by.to) {
      case PushTo::left:
        return kPi / 2;
      case PushTo::right:
        return -kPi / 2;
      case PushTo::sides:
        return dice.side() * kPi / 2;
      case PushTo::ahead:
        return 0.0;
      case PushTo::back:
        return kPi;
      case PushTo::around:
        return dice(-kPi, kPi);
    }
    return 0.0;
  };
  for (double at = by.from_s; at < kLast_s; at += by.every_s) {
    const double to = direction();
    pushes.push_back({at, by.impulse_ns * Eigen::Vector2d(std::cos(to), std::sin(to))});
  }
}

std::size_t Scenario::pushes_within(double seconds) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(pushes, [&](const Push& push) { return push.at_s < seconds; }));
}

// Light, and what the floor looks like, where a kind of world has its own.
void Scenario::dress() {
  // Of no ball's colour.
  static const std::vector<std::array<double, 3>> paints{{0.72, 0.60, 0.44}, {0.35, 0.42, 0.55},
                                                         {0.80, 0.80, 0.78}, {0.45, 0.32, 0.22},
                                                         {0.55, 0.55, 0.57}, {0.30, 0.30, 0.32}};
  if (kind == WorldKind::patterned_floor || kind == WorldKind::plain_floor) {
    floor = kind == WorldKind::plain_floor ? "plain" : "checker";
    floor_rgb = one_of(paints, seed, Draw::paint);
  }
  if (kind == WorldKind::dark) {
    constexpr Interval kDark{0.03, 0.12};  // a fifth to a third of the usual codes in pictures
    lamp = within(kDark, seed, Draw::lamp);
    shade = within(kDark, seed, Draw::shade);
  }
}

Result<void> Scenario::add_layout(const Variation& variation, bool ball_is_goal) {
  has_ball = ball_is_goal;
  dress();
  const LayoutRange range{variation.bearing_deg, variation.goal_distance_m, variation.density,
                          variation.max_obstacles};
  for (std::uint64_t draw = 0; draw < 100; ++draw) {
    layout = draw_layout(kind, range, seed + draw * 7919, ball_is_goal, {ball_x_m, ball_y_m});
    const auto least = KAZ_TRY(least_seconds(layout));
    if (!least) continue;
    least_s = *least;
    if (ball_is_goal) {
      ball_x_m = layout.goal.x();
      ball_y_m = layout.goal.y();
    }
    paint_balls();
    return {};
  }
  return fail(Fault::usage, std::string("100 random layouts of world ") + to_string(kind) +
                                " had no path to the goal: give fewer --obstacles or a lower "
                                "--density");
}

Result<void> Scenario::add_props(const Variation& variation) {
  Dice dice(seed, Draw::clutter);
  const auto more = static_cast<std::size_t>(variation.props.max - variation.props.min + 1);
  const std::size_t count = static_cast<std::size_t>(variation.props.min) + dice.below(more);
  const Eigen::Vector2d ball(ball_x_m, ball_y_m);
  const auto color = KAZ_TRY(tools::ball_color(ball_color));
  // The robot walks straight to the ball, its hands 15 cm to each side of the way.
  constexpr double kFromStart = 0.30, kFromWay = 0.24, kApart = 0.05, kNear = 0.35, kFar = 1.6;
  const auto fits = [&](const Obstacle& o) {
    for (double share = 0; share <= 1; share += 0.02)
      if (distance_to(o, share * ball) < kFromWay) return false;
    return distance_to(o, {0, 0}) > kFromStart &&
           std::ranges::none_of(layout.obstacles, [&](const Obstacle& other) {
             const double between = (o.place() - other.place()).norm();
             return between < (std::hypot(o.length_m, o.width_m) +
                               std::hypot(other.length_m, other.width_m)) /
                                      2 +
                                  kApart;
           });
  };
  for (int draw = 0; layout.obstacles.size() < count; ++draw) {
    if (draw == 10'000)
      return fail(Fault::usage, "there is no room for " + std::to_string(count) +
                                    " props around robot and ball: give fewer --props");
    const bool alike = layout.obstacles.size() % 3 == 0;
    const Obstacle o = draw_prop(dice, kNear, kFar, alike ? &color.rgb : nullptr);
    if (fits(o)) layout.obstacles.push_back(o);
  }
  return {};
}

void Scenario::lay_down() {
  lies = std::array{Lies::on_face, Lies::on_back, Lies::on_left,
                    Lies::on_right}[static_cast<std::size_t>(4 * evenly(seed, Draw::lies))];
}

// Each of its own colour, none that of the ball to catch.
void Scenario::paint_balls() {
  std::vector<std::array<double, 3>> others;
  for (const BallColor& color : ball_colors())
    if (!has_ball || color.name != ball_color) others.push_back(color.rgb);
  std::size_t next = seed % others.size();
  for (Obstacle& o : layout.obstacles)
    if (o.shape == Shape::ball) o.rgb = others[next++ % others.size()];
}

const Obstacle* Scenario::moving() const {
  const auto found =
      std::ranges::find_if(layout.obstacles, [](const Obstacle& o) { return o.slide.has_value(); });
  return found == layout.obstacles.end() ? nullptr : &*found;
}

std::string Scenario::name_of(const Obstacle& obstacle) const {
  return kObstacleName + std::to_string(&obstacle - layout.obstacles.data());
}

Eigen::Isometry2d Scenario::world_from_start() const {
  return Eigen::Translation2d(start_x_m, start_y_m) * Eigen::Rotation2Dd(start_yaw_rad);
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
  if (!s.pushes.empty()) {
    json["push_ns"] = s.pushes.front().impulse.norm();
    json["push_every_s"] = s.pushes.size() > 1 ? s.pushes[1].at_s - s.pushes[0].at_s : 0.0;
  }
  if (s.lies)
    json["lies"] = std::array{"on its face", "on its back", "on its left side",
                              "on its right side"}[static_cast<std::size_t>(*s.lies)];
  if (s.least_s <= 0 && !s.layout.obstacles.empty()) json["props"] = s.layout.obstacles.size();
  if (s.least_s > 0) {
    const Layout& layout = s.layout;
    json["world"] = to_string(s.kind);
    json["density"] = layout.density;
    json["obstacles"] = layout.obstacles.size();
    json["goal_m"] = {layout.goal.x(), layout.goal.y()};
    if (layout.goal_heading_rad) json["goal_heading_rad"] = *layout.goal_heading_rad;
    json["least_s"] = s.least_s;
    if (const Obstacle* moving = s.moving()) {
      const Obstacle rest = at_rest(*moving);
      json["moving"] = {{"at_s", moving->slide->at_s},
                        {"from_m", {moving->x_m, moving->y_m}},
                        {"to_m", {rest.x_m, rest.y_m}}};
    }
  }
  return json;
}

Result<trials::RobotFolder> scenario_files(const Scenario& scenario, const std::string& robot) {
  const auto world = KAZ_TRY(world_text(scenario));
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
