// Draws the map of a behavior, and converts it for the recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "host/behavior/sink.h"
#include "sim/runtime/simulation/recorded_map.h"
#include "tools/figure/figure.h"

namespace kaz::tools {

// Part of a map in a picture. Forward is up, left is left.
struct MapWindow {
  Eigen::Vector2d min{0, 0}, max{0, 0};  // m, map frame: rear right and front left corner
  double px_per_m = 300;
  int width() const;
  int height() const;
  // Returns column and row of a position in m. Pixel centers are at integers.
  std::pair<double, double> pixel(const Eigen::Vector2d& at) const;
};

// Returns a window with all known cells, robot, path, trail and goal, plus a margin of 15 cm.
MapWindow window_of(const behavior::MapReport& report);

// - green_red: as LocalMap::picture().
// - paper: as figure 6 (B) and (C) of the paper. Floor is white, brighter with its confidence. Obstacles are
//   black, unknown cells gray.
// - states: as paper, but without the confidence, as the planner uses the map.
enum class MapColors { green_red, paper, states };
figure::Image map_cells(const map::LocalMap& map, const MapWindow& window, MapColors colors);
void draw_map_grid(figure::Image& image, const MapWindow& window, double every_m,
                   figure::Color color);
// Draws the robot as a black arrow.
void draw_map_robot(figure::Image& image, const MapWindow& window, const Eigen::Vector2d& at,
                    double heading_rad);
void draw_map_line(figure::Image& image, const MapWindow& window,
                   const std::vector<Eigen::Vector2d>& corners, figure::Color color,
                   double width_px);

// Draws the window of window_of(). Floor is green, obstacles red, unknown cells gray. The trail is blue, the
// path white, the goal a yellow crosshair, the robot a black arrow. Grid lines are 0.5 m apart.
figure::Image map_picture(const behavior::MapReport& report);

sim::RecordedMap recorded_map(const behavior::MapReport& report);

}  // namespace kaz::tools
