// Draws map, path and robot.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/map_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "host/map/local_map.h"

namespace kaz::tools {
namespace {

using Eigen::Vector2d;

constexpr int kCell_px = 3;
constexpr double kMargin = 0.15, kGridline = 0.5;  // m

using Rgb = std::array<std::uint8_t, 3>;

constexpr Rgb kOutside{150, 150, 150};

// The part of the map in the picture.
struct MapWindow {
  Vector2d min{0, 0}, max{0, 0};  // rear right and front left corner; m, map frame
  double px_per_m = 300;
  int width() const;
  int height() const;
  // Column and row of a place.
  std::pair<double, double> pixel(const Vector2d& at) const;
};

int MapWindow::width() const {
  return static_cast<int>(std::lround((max.y() - min.y()) * px_per_m));
}

int MapWindow::height() const {
  return static_cast<int>(std::lround((max.x() - min.x()) * px_per_m));
}

std::pair<double, double> MapWindow::pixel(const Vector2d& at) const {
  return {(max.y() - at.y()) * px_per_m - 0.5, (max.x() - at.x()) * px_per_m - 0.5};
}

MapWindow window_of(const behavior::MapReport& report) {
  const map::LocalMap& map = report.map;
  Vector2d min = report.robot, max = report.robot;
  const auto show = [&](const Vector2d& at) {
    min = min.cwiseMin(at);
    max = max.cwiseMax(at);
  };
  show(report.goal);
  for (const Vector2d& at : report.path) show(at);
  for (const Vector2d& at : report.trail) show(at);
  for (int x = 0; x < map.cells(); ++x) {
    for (int y = 0; y < map.cells(); ++y) {
      if (map.cell(x, y).state != map::CellState::unknown) show({map.middle(x), map.middle(y)});
    }
  }
  const double cell = map.options().cell_m;
  const auto whole = [&](double m, double away) { return cell * std::round((m + away) / cell); };
  return {{whole(min.x(), -kMargin), whole(min.y(), -kMargin)},
          {whole(max.x(), kMargin), whole(max.y(), kMargin)},
          kCell_px / cell};
}

figure::Image map_cells(const map::LocalMap& map, const MapWindow& window) {
  const figure::Image all = map.picture();
  figure::Image image{window.width(), window.height(), {}};
  image.rgb.reserve(3 * static_cast<std::size_t>(image.width) *
                    static_cast<std::size_t>(image.height));
  const auto color_of = [&](int x, int y) -> Rgb {
    if (x < 0 || y < 0 || x >= map.cells() || y >= map.cells()) return kOutside;
    const auto row = static_cast<std::size_t>(map.cells() - 1 - x),
               column = static_cast<std::size_t>(map.cells() - 1 - y);
    const auto from = &all.rgb[3 * (row * static_cast<std::size_t>(all.width) + column)];
    return {from[0], from[1], from[2]};
  };
  for (int v = 0; v < image.height; ++v) {
    const int x = map.number(window.max.x() - (v + 0.5) / window.px_per_m);
    for (int u = 0; u < image.width; ++u) {
      const Rgb color = color_of(x, map.number(window.max.y() - (u + 0.5) / window.px_per_m));
      image.rgb.insert(image.rgb.end(), color.begin(), color.end());
    }
  }
  return image;
}

void draw_map_grid(figure::Image& image, const MapWindow& window, double every_m,
                   figure::Color color) {
  std::vector<std::vector<std::pair<double, double>>> lines;
  for (const int axis : {0, 1}) {
    for (double at = every_m * std::ceil(window.min[axis] / every_m); at < window.max[axis];
         at += every_m) {
      Vector2d from = window.min, to = window.max;
      from[axis] = to[axis] = at;
      lines.push_back({window.pixel(from), window.pixel(to)});
    }
  }
  figure::draw_lines(image, lines, color, 0.4);
}

void draw_map_line(figure::Image& image, const MapWindow& window,
                   const std::vector<Vector2d>& corners, figure::Color color, double width_px) {
  std::vector<std::pair<double, double>> pixels;
  for (const Vector2d& at : corners) pixels.push_back(window.pixel(at));
  figure::draw_line(image, pixels, color, width_px);
}

void draw_map_robot(figure::Image& image, const MapWindow& window, const Vector2d& at,
                    double heading_rad) {
  const Vector2d ahead(std::cos(heading_rad), std::sin(heading_rad)), left(-ahead.y(), ahead.x());
  draw_map_line(image, window,
                {at - 0.04 * ahead + 0.04 * left, at + 0.07 * ahead,
                 at - 0.04 * ahead - 0.04 * left, at - 0.04 * ahead + 0.04 * left},
                figure::kBlack, 2.5);
}

}  // namespace

figure::Image map_picture(const behavior::MapReport& report) {
  const MapWindow window = window_of(report);
  figure::Image image = map_cells(report.map, window);
  draw_map_grid(image, window, kGridline, figure::kWhite);
  const double axis = 2 * (window.max - window.min).norm();  // beyond the picture
  for (const Vector2d& along : {Vector2d(axis, 0), Vector2d(0, axis)})
    draw_map_line(image, window, {-along, along}, figure::kWhite, 1.2);
  draw_map_line(image, window, report.trail, figure::kBlue, 3);
  draw_map_line(image, window, report.path, figure::kWhite, 2);
  draw_map_robot(image, window, report.robot, report.heading_rad);
  const auto [u, v] = window.pixel(report.goal);
  figure::draw_crosshair(image, u, v, 12, figure::kYellow, 3);
  const char* const legend[] = {"green: floor, red: obstacle, gray: not seen; paler: less certain",
                                "blue: walked, white: path, yellow: goal, black: robot",
                                "lines every 0.5 m; the thicker lines meet at the start"};
  for (int line = 0; line < 3; ++line)
    figure::draw_text(image, 6, image.height - 36 + 14 * line, legend[line], 11, figure::kWhite);
  return image;
}

sim::RecordedMap recorded_map(const behavior::MapReport& report) {
  const map::LocalMap& map = report.map;
  const double cell_m = map.options().cell_m, corner = map.middle(0) - cell_m / 2;
  sim::RecordedMap out{cell_m, map.cells(), map.cells(),  {corner, corner},
                       {},     report.path, report.robot, report.heading_rad};
  out.cells.reserve(static_cast<std::size_t>(map.cells()) * static_cast<std::size_t>(map.cells()));
  for (int y = 0; y < map.cells(); ++y) {
    for (int x = 0; x < map.cells(); ++x) {
      const bool known = map.cell(x, y).state != map::CellState::unknown;
      const double probability = 1 / (1 + std::exp(-map.log_odds(x, y)));
      out.cells.push_back(
          static_cast<std::int8_t>(known ? std::lround(100 * probability) : std::int64_t{-1}));
    }
  }
  return out;
}

}  // namespace kaz::tools
