// What differs from episode to episode, and the files that make it so.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "tools/app/evaluate/layout.h"
#include "tools/trials/robot_folder.h"

namespace kaz::tools {

// A colour in which balls are painted. How one is looked for is learned (learned_color.h).
struct BallColor {
  const char* name;
  std::array<double, 3> rgb;  // 0..1
};
std::span<const BallColor> ball_colors();
// Fails (usage) with the names that there are.
Result<BallColor> ball_color(const std::string& name);

// Names of floors: textures, and "plain".
std::span<const char* const> floor_names();

// Where pushes go: of the robot's start, where `sides` and `around` draw each.
enum class PushTo { left, right, sides, ahead, back, around };
constexpr const char* to_string(PushTo to) {
  switch (to) {
    case PushTo::left:
      return "left";
    case PushTo::right:
      return "right";
    case PushTo::sides:
      return "sides";
    case PushTo::ahead:
      return "ahead";
    case PushTo::back:
      return "back";
    case PushTo::around:
      return "around";
  }
  return "";
}
inline constexpr std::array kPushTo{PushTo::left,  PushTo::right, PushTo::sides,
                                    PushTo::ahead, PushTo::back,  PushTo::around};

// Pushes on the trunk, at its centre of mass, as long as an episode can last.
struct Pushes {
  double impulse_ns = 0;        // N s; 0: none
  double from_s = 0.1;          // of the first one
  bool from_first_step = true;  // times are since the robot's first step; else since the start
  double every_s = 1.5;
  PushTo to = PushTo::sides;
};

struct Variation {
  Interval friction{0.6, 0.8};         // of the floor
  Interval supply_volts{9.5, 10.5};    // at the board
  Interval ball_distance_m{0.3, 0.8};  // from between the feet, on the floor
  double bearing_deg = 90;             // of the ball, at most so far to either side
  std::vector<double> radii_m{0.018, 0.020};
  std::vector<std::string> colors{"red", "green"};
  Interval lamp_height_deg{35, 80};  // over the horizon
  Interval lamp{0.5, 1.3}, shade{0.6, 1.3};
  std::vector<std::string> floors{"wood", "carpet", "checker"};  // floor_names()
  // How many props stand about where the behaviour does not walk around things; none on the way to the ball,
  // every third of the ball's colour but of another shape or size.
  Interval props{0, 0};
  double mass_sigma = 0.05;  // of each link's mass and inertia, as a share
  // Of behaviours that walk around things: kinds of worlds, taken in turn, how dense they are, how many
  // obstacles clutter has, half of it to all, and how far the goal is.
  std::vector<WorldKind> worlds{WorldKind::clutter};
  Interval density{0, 1};
  int max_obstacles = 8;
  Interval goal_distance_m{0.7, 1.5};
  Pushes pushes;
};

// Begins the names of what is not to be touched.
constexpr char kObstacleName[] = "thing";

// How a robot lies that is to get up.
enum class Lies { on_face, on_back, on_left, on_right };

struct Scenario {
  std::uint64_t seed = 1;  // of the episode: sensors, and all below
  // In the world: where the robot starts, and the light.
  double start_x_m = 0, start_y_m = 0, start_yaw_rad = 0;
  double lamp_azimuth_rad = 0, lamp_height_rad = 1, lamp = 1,
         shade = 1;  // factors: docs/reference/worlds.md
  double friction = 0.7, supply_volts = 10;
  double ball_x_m = 0, ball_y_m = 0;  // from between the feet; x ahead, y left
  double ball_radius_m = 0.020;
  std::string ball_color = "red", floor = "wood";  // floor: a texture, or "plain"
  std::array<double, 3> floor_rgb{0.72, 0.60, 0.44};
  double mass_sigma = 0.05;
  // On the trunk: when (s, since the first step or the start), and the impulse (N s), in axes of the start.
  struct Push {
    double at_s;
    Eigen::Vector2d impulse;
  };
  std::vector<Push> pushes = {};
  bool pushes_from_first_step = true;
  // With a world to walk in: a goal that can be reached, and the least time of walking there, by the true
  // places of all things. The ball is then the goal; or there is none (has_ball).
  WorldKind kind = WorldKind::clutter;
  Layout layout = {};
  bool has_ball = true;
  std::optional<Lies> lies = {};
  double least_s = 0;

  // Of the evaluation's seed and the episode's number, and nothing else.
  static Scenario draw(const Variation& variation, std::uint64_t seed, std::uint64_t episode);
  // Adds props to its layout. Errors (usage): there is no room for them.
  Result<void> add_props(const Variation& variation);
  // The robot begins lying, in one of the four ways, motors off.
  void lay_down();
  // Adds a world of its `kind` to walk in; `ball_is_goal`: the ball is there. Errors: none in a hundred draws
  // leaves a way.
  Result<void> add_layout(const Variation& variation, bool ball_is_goal);
  // What slides into the way; null where nothing does.
  const Obstacle* moving() const;
  // Model of one of the layout's obstacles in the world; those of floor, table and the ball to catch have
  // other names.
  std::string name_of(const Obstacle& obstacle) const;
  Eigen::Isometry2d world_from_start() const;
  // Pushes in the first `seconds` since they are timed.
  std::size_t pushes_within(double seconds) const;

 private:
  void draw_pushes(const Pushes& pushes);
  void dress();
  void paint_balls();
};
nlohmann::ordered_json scenario_json(const Scenario& scenario);

// The world as SDF. Errors (usage): there is no such colour of a ball.
Result<std::string> world_text(const Scenario& scenario);
// Robot and world of a scenario. `robot`: folder of kaz.urdf and its companions. Errors: a file that
// cannot be read or written.
Result<trials::RobotFolder> scenario_files(const Scenario& scenario, const std::string& robot);

}  // namespace kaz::tools
