// The map of a behaviour as a picture, and as the recording takes it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "host/behavior/sink.h"
#include "sim/runtime/simulation/recorded_map.h"
#include "tools/figure/figure.h"

namespace kaz::tools {

// The part of a map that a picture shows. Forward is up, left is left.
struct MapWindow {
  Eigen::Vector2d min{0, 0}, max{0, 0};  // m, map frame: rear right and front left corner
  double px_per_m = 300;
  int width() const;
  int height() const;
  // Column and row of a place, pixel centres at integers.
  std::pair<double, double> pixel(const Eigen::Vector2d& at) const;
};

// All that is known, path, trail and goal, and 15 cm around.
MapWindow window_of(const behavior::MapReport& report);

// green_red: as LocalMap::picture(). paper: as the paper's figure 6 (B) and (C): floor white, brighter with
// its confidence, obstacles black, unknown grey. states: the same without the confidence, as the planner has
// it.
enum class MapColors { green_red, paper, states };
figure::Image map_cells(const map::LocalMap& map, const MapWindow& window, MapColors colors);
void draw_map_grid(figure::Image& image, const MapWindow& window, double every_m,
                   figure::Color color);
// Robot as an arrow.
void draw_map_robot(figure::Image& image, const MapWindow& window, const Eigen::Vector2d& at,
                    double heading_rad);
void draw_map_line(figure::Image& image, const MapWindow& window,
                   const std::vector<Eigen::Vector2d>& corners, figure::Color color,
                   double width_px);

// Forward is up. Floor green, obstacles red, unknown grey; where the robot walked blue, the path ahead black
// and white, goal a crosshair, robot an arrow; a grid of 0.5 m. Shows all that is known, and path and goal.
figure::Image map_picture(const behavior::MapReport& report);

sim::RecordedMap recorded_map(const behavior::MapReport& report);

}  // namespace kaz::tools
