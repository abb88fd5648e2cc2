// Draws the conditions of an episode, and writes the files of its world and robot.
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
#include "tools/eval/layout.h"
#include "tools/trials/robot_folder.h"

namespace kaz::tools {

// Paint of a ball. The range of colors that the detector looks for is learned from a picture
// (learned_color.h).
struct BallColor {
  const char* name;
  std::array<double, 3> rgb;  // 0..1
};
std::span<const BallColor> ball_colors();
// Fails (usage) for an unknown name; the message lists all names.
Result<BallColor> ball_color(const std::string& name);

// Returns the names of floors: the names of textures, and "plain".
std::span<const char* const> floor_names();

// Direction of pushes relative to the robot's start. For `sides` and `around`, the direction of each push is
// drawn.
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

// Repeated pushes at the trunk's center of mass, until the latest possible end of an episode.
struct Pushes {
  double impulse_ns = 0;  // impulse of each push, N s; 0: no pushes
  double from_s = 0.1;    // time of the first push
  // True: times count from the robot's first step; false: from the start.
  bool from_first_step = true;
  double every_s = 1.5;
  PushTo to = PushTo::sides;
};

struct Variation {
  Interval friction{0.6, 0.8};         // friction of the floor
  Interval supply_volts{9.5, 10.5};    // supply voltage at the board
  Interval ball_distance_m{0.3, 0.8};  // distance on the floor from the point between the feet
  // Largest angle between the ball's direction and straight ahead, to either side.
  double bearing_deg = 90;
  std::vector<double> radii_m{0.018, 0.020};
  std::vector<std::string> colors{"red", "green"};
  Interval lamp_height_deg{35, 80};  // elevation of the lamp above the horizon
  // Factors of brightness (docs/reference/worlds.md).
  Interval lamp{0.5, 1.3}, shade{0.6, 1.3};
  std::vector<std::string> floors{"wood", "carpet", "checker"};  // floor_names()
  // Number of props (distractors), for behaviors that do not avoid obstacles. Props never stand on the way to
  // the ball. Every third prop has the ball's color, but another shape or size.
  Interval props{0, 0};
  double mass_sigma = 0.05;  // relative standard deviation of each link's mass and inertia
  // The members from here to goal_distance_m are for behaviors that avoid obstacles. `worlds`: kinds of
  // worlds, used in turn. max_obstacles: largest number of obstacles in clutter; at least half of this number
  // is used.
  std::vector<WorldKind> worlds{WorldKind::clutter};
  Interval density{0, 1};
  int max_obstacles = 8;
  Interval goal_distance_m{0.7, 1.5};
  Pushes pushes;
};

// Prefix of the model names of objects that the robot must not touch.
constexpr char kObstacleName[] = "thing";

// Initial pose of a robot that must get up from the floor.
enum class Lies { on_face, on_back, on_left, on_right };

struct Scenario {
  std::uint64_t seed = 1;  // seed of the episode; used for sensors and for all members below
  // Start of the robot, and light, in the world frame.
  double start_x_m = 0, start_y_m = 0, start_yaw_rad = 0;
  // lamp, shade: factors of brightness (docs/reference/worlds.md).
  double lamp_azimuth_rad = 0, lamp_height_rad = 1, lamp = 1, shade = 1;
  double friction = 0.7, supply_volts = 10;
  // Position relative to the point between the feet; x ahead, y left.
  double ball_x_m = 0, ball_y_m = 0;
  double ball_radius_m = 0.020;
  std::string ball_color = "red", floor = "wood";  // floor: name of a texture, or "plain"
  std::array<double, 3> floor_rgb{0.72, 0.60, 0.44};
  double mass_sigma = 0.05;
  // A push on the trunk. at_s: time in s since the robot's first step or since the start
  // (pushes_from_first_step). `impulse`: N s, in the axes of the robot's start.
  struct Push {
    double at_s;
    Eigen::Vector2d impulse;
  };
  std::vector<Push> pushes = {};
  bool pushes_from_first_step = true;
  // The members below are for behaviors that walk to a goal. `layout` has a reachable goal, and least_s is
  // the shortest walking time to the goal around the true obstacles. If has_ball is true, the ball is the
  // goal.
  WorldKind kind = WorldKind::clutter;
  Layout layout = {};
  bool has_ball = true;
  std::optional<Lies> lies = {};
  double least_s = 0;

  // Draws a scenario. The result depends only on the arguments.
  static Scenario draw(const Variation& variation, std::uint64_t seed, std::uint64_t episode);
  // Adds props to the layout. Fails (usage) if the world has not enough room for the props.
  Result<void> add_props(const Variation& variation);
  // Makes the robot start lying in one of the four poses, with motors off.
  void lay_down();
  // Draws `layout`, a world of the kind `kind` to walk in. `ball_is_goal`: the goal is the ball. Draws up to
  // 100 worlds. Fails (usage) if no drawn world has a path to the goal.
  Result<void> add_layout(const Variation& variation, bool ball_is_goal);
  // Returns the obstacle that slides into the robot's way; null if no obstacle slides.
  const Obstacle* moving() const;
  // Returns the model name of an obstacle of the layout. The name differs from the names of floor, table and
  // target ball.
  std::string name_of(const Obstacle& obstacle) const;
  Eigen::Isometry2d world_from_start() const;
  // Returns the number of pushes whose Push::at_s is less than `seconds`.
  std::size_t pushes_within(double seconds) const;

 private:
  void draw_pushes(const Pushes& pushes);
  void dress();
  void paint_balls();
};
nlohmann::ordered_json scenario_json(const Scenario& scenario);

// Returns the world as SDF. Fails (usage) if the ball's color is unknown.
Result<std::string> world_text(const Scenario& scenario);
// Writes the files of a scenario's robot and world to a folder. `robot`: folder that contains kaz.urdf and
// the other files of the robot. Fails if a file cannot be read or written.
Result<trials::RobotFolder> scenario_files(const Scenario& scenario, const std::string& robot);

}  // namespace kaz::tools
