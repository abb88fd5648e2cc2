// Draws the conditions of an episode, and writes the files for them.
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

// Color of a painted ball. The detector's color range is learned (learned_color.h).
struct BallColor {
  const char* name;
  std::array<double, 3> rgb;  // 0..1
};
std::span<const BallColor> ball_colors();
// Fails (usage) for an unknown name; the message lists all names.
Result<BallColor> ball_color(const std::string& name);

// Returns the floor names: textures, and "plain".
std::span<const char* const> floor_names();

// Direction of pushes relative to the robot's start. `sides` and `around` draw each direction.
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

// Pushes on the trunk at its center of mass, repeated for as long as an episode can last.
struct Pushes {
  double impulse_ns = 0;        // N s; 0: none
  double from_s = 0.1;          // time of the first push
  bool from_first_step = true;  // times count since the robot's first step; else since the start
  double every_s = 1.5;
  PushTo to = PushTo::sides;
};

struct Variation {
  Interval friction{0.6, 0.8};         // friction of the floor
  Interval supply_volts{9.5, 10.5};    // at the board
  Interval ball_distance_m{0.3, 0.8};  // on the floor, from between the feet
  double bearing_deg = 90;             // largest bearing of the ball to either side
  std::vector<double> radii_m{0.018, 0.020};
  std::vector<std::string> colors{"red", "green"};
  Interval lamp_height_deg{35, 80};  // above the horizon
  // Factors of brightness (docs/reference/worlds.md).
  Interval lamp{0.5, 1.3}, shade{0.6, 1.3};
  std::vector<std::string> floors{"wood", "carpet", "checker"};  // floor_names()
  // Number of props (distractors), for behaviors that do not avoid obstacles. Props never stand on the way to
  // the ball. Every third one has the ball's color, but another shape or size.
  Interval props{0, 0};
  double mass_sigma = 0.05;  // relative, for each link's mass and inertia
  // The rest is for behaviors that avoid obstacles. Kinds of worlds, used in turn; their density; the largest
  // number of obstacles in clutter, of which at least half are used; distance of the goal.
  std::vector<WorldKind> worlds{WorldKind::clutter};
  Interval density{0, 1};
  int max_obstacles = 8;
  Interval goal_distance_m{0.7, 1.5};
  Pushes pushes;
};

// Prefix of the model names of objects that the robot must not touch.
constexpr char kObstacleName[] = "thing";

// Initial pose of a robot that is to get up.
enum class Lies { on_face, on_back, on_left, on_right };

struct Scenario {
  std::uint64_t seed = 1;  // seed of the episode, for sensors and everything below
  // World frame: start of the robot, and light.
  double start_x_m = 0, start_y_m = 0, start_yaw_rad = 0;
  // lamp, shade: factors of brightness (docs/reference/worlds.md).
  double lamp_azimuth_rad = 0, lamp_height_rad = 1, lamp = 1, shade = 1;
  double friction = 0.7, supply_volts = 10;
  double ball_x_m = 0, ball_y_m = 0;  // from between the feet; x ahead, y left
  double ball_radius_m = 0.020;
  std::string ball_color = "red", floor = "wood";  // floor: a texture, or "plain"
  std::array<double, 3> floor_rgb{0.72, 0.60, 0.44};
  double mass_sigma = 0.05;
  // Push on the trunk: time (s since the first step or the start) and impulse (N s), in the axes of the
  // start.
  struct Push {
    double at_s;
    Eigen::Vector2d impulse;
  };
  std::vector<Push> pushes = {};
  bool pushes_from_first_step = true;
  // For behaviors that walk to a goal: a reachable goal, and the shortest walking time to it, by the true
  // obstacles. The ball is then the goal, or there is no ball (has_ball).
  WorldKind kind = WorldKind::clutter;
  Layout layout = {};
  bool has_ball = true;
  std::optional<Lies> lies = {};
  double least_s = 0;

  // Draws a scenario. It depends only on its arguments.
  static Scenario draw(const Variation& variation, std::uint64_t seed, std::uint64_t episode);
  // Adds props to the layout. Fails (usage) if there is not enough room.
  Result<void> add_props(const Variation& variation);
  // Makes the robot start lying in one of the four poses, with motors off.
  void lay_down();
  // Adds a world of its `kind` to walk in. `ball_is_goal`: the goal is the ball. Fails (usage) if none of 100
  // draws has a path to the goal.
  Result<void> add_layout(const Variation& variation, bool ball_is_goal);
  // Returns the obstacle that slides into the way; null if no obstacle slides.
  const Obstacle* moving() const;
  // Returns the model name of an obstacle of the layout. Floor, table and target ball have other names.
  std::string name_of(const Obstacle& obstacle) const;
  Eigen::Isometry2d world_from_start() const;
  // Counts the pushes in the first `seconds` after their time zero.
  std::size_t pushes_within(double seconds) const;

 private:
  void draw_pushes(const Pushes& pushes);
  void dress();
  void paint_balls();
};
nlohmann::ordered_json scenario_json(const Scenario& scenario);

// Returns the world as SDF. Fails (usage) if the ball's color is unknown.
Result<std::string> world_text(const Scenario& scenario);
// Writes robot and world of a scenario to a folder. `robot`: folder of kaz.urdf and its companions. Fails if
// a file cannot be read or written.
Result<trials::RobotFolder> scenario_files(const Scenario& scenario, const std::string& robot);

}  // namespace kaz::tools
