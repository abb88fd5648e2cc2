// What differs from episode to episode, and the files that make it so.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "tools/trials/robot_folder.h"
#include "tools/trials/statistics.h"
#include "vision/color/color.h"

namespace kaz::tools {

// A colour that balls have: as painted, and as it is looked for.
struct BallColor {
  const char* name;
  std::array<double, 3> rgb;  // 0..1
  vision::ColorRange range;
};
std::span<const BallColor> ball_colors();
// Fails (usage) with the names that there are.
Result<BallColor> ball_color(const std::string& name);

// From where to where something is drawn, evenly.
using trials::Interval;

// A box or, `round`, a can that stands on the floor; from between the feet of the start, x ahead.
struct Obstacle {
  double x_m = 0, y_m = 0, yaw_rad = 0;
  double length_m = 0.1, width_m = 0.1, height_m = 0.1;  // of a can, length and width are its diameter
  bool round = false;
  std::array<double, 3> rgb{0.5, 0.5, 0.5};
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
  double mass_sigma = 0.05;  // of each link's mass and inertia, as a share
  // Of behaviours that walk around things: how many stand about, half of it to all, and how far the goal is.
  int max_obstacles = 8;
  Interval goal_distance_m{0.7, 1.5};
};

struct Scenario {
  std::uint64_t seed = 1;  // of the episode: sensors, and all below
  // In the world: where the robot starts, and the light.
  double start_x_m = 0, start_y_m = 0, start_yaw_rad = 0;
  double lamp_azimuth_rad = 0, lamp_height_rad = 1, lamp = 1, shade = 1;  // factors: docs/reference/worlds.md
  double friction = 0.7, supply_volts = 10;
  double ball_x_m = 0, ball_y_m = 0;  // from between the feet; x ahead, y left
  double ball_radius_m = 0.020;
  std::string ball_color = "red", floor = "wood";
  double mass_sigma = 0.05;
  // With obstacles: a goal that can be reached between them, and the least time of walking there, by their
  // true places. The ball is then the goal; or there is none (has_ball).
  std::vector<Obstacle> obstacles = {};
  bool has_ball = true;
  double goal_x_m = 0, goal_y_m = 0, goal_heading_rad = 0;
  bool goal_has_heading = false;
  double least_s = 0;

  // Of the evaluation's seed and the episode's number, and nothing else.
  static Scenario draw(const Variation& variation, std::uint64_t seed, std::uint64_t episode);
  // Adds obstacles and goal; `ball_is_goal`: the ball's place is it. Errors: none in a hundred draws leaves
  // a way.
  Result<void> add_obstacles(const Variation& variation, bool ball_is_goal);
};
nlohmann::ordered_json scenario_json(const Scenario& scenario);

// Robot and world of a scenario. `robot`: folder of kaz.urdf and its companions. Errors: a file that
// cannot be read or written.
Result<trials::RobotFolder> scenario_files(const Scenario& scenario, const std::string& robot);

}  // namespace kaz::tools
