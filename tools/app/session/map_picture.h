// Draws the map of a behavior, and converts the map for the recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "host/behavior/sink.h"
#include "sim/runtime/simulation/recorded_map.h"
#include "tools/figure/figure.h"

namespace kaz::tools {

// Part of a map that a picture shows. The map's x axis (forward) points up in the picture, and its y axis
// (left) points to the left.
struct MapWindow {
  // Rear right and front left corner of the window; m, map frame.
  Eigen::Vector2d min{0, 0}, max{0, 0};
  double px_per_m = 300;
  int width() const;
  int height() const;
  // Returns column and row of the position `at`, which is in m. Pixel centers are at integers.
  std::pair<double, double> pixel(const Eigen::Vector2d& at) const;
};

// Returns a window that contains all known cells, robot, path, trail and goal, with a margin of 15 cm.
MapWindow window_of(const behavior::MapReport& report);

// - green_red: the colors of LocalMap::picture().
// - paper: the colors of figure 6 (B) and (C) of the paper. Floor is white, and brighter if its confidence is
//   higher. Obstacles are black, unknown cells gray.
// - states: like `paper`, but the brightness does not depend on the confidence. The planner uses the same
//   states.
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

// Draws the map in the window that window_of() returns. Floor is green, obstacles red, unknown cells gray.
// The trail is blue, the path white, the goal a yellow crosshair, the robot a black arrow. Grid lines are 0.5
// m apart.
figure::Image map_picture(const behavior::MapReport& report);

sim::RecordedMap recorded_map(const behavior::MapReport& report);

}  // namespace kaz::tools
