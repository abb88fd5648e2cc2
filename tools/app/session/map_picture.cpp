// Draws map, path and robot.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/session/map_picture.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "host/map/local_map.h"

namespace kaz::tools {
namespace {

using Eigen::Vector2d;

constexpr int kCell_px = 3;
constexpr double kMargin = 0.15, kGridline = 0.5;  // m

// The part of the map that is shown.
struct Window {
  Vector2d min, max;  // m
  double px_per_m;
  int width() const { return static_cast<int>(std::lround((max.y() - min.y()) * px_per_m)); }
  int height() const { return static_cast<int>(std::lround((max.x() - min.x()) * px_per_m)); }
  std::pair<double, double> pixel(const Vector2d& at) const {
    return {(max.y() - at.y()) * px_per_m - 0.5, (max.x() - at.x()) * px_per_m - 0.5};
  }
};

Window window_of(const behavior::MapReport& report) {
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

figure::Image cells_of(const map::LocalMap& map, const Window& window) {
  const figure::Image all = map.picture();
  figure::Image image{window.width(), window.height(), {}};
  image.rgb.reserve(3 * static_cast<std::size_t>(image.width) *
                    static_cast<std::size_t>(image.height));
  for (int v = 0; v < image.height; ++v) {
    const int x = map.number(window.max.x() - (v + 0.5) / window.px_per_m);
    for (int u = 0; u < image.width; ++u) {
      const int y = map.number(window.max.y() - (u + 0.5) / window.px_per_m);
      const bool inside = x >= 0 && y >= 0 && x < map.cells() && y < map.cells();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto row = static_cast<std::size_t>(map.cells() - 1 - x),
                   column = static_cast<std::size_t>(map.cells() - 1 - y);
        image.rgb.push_back(
            inside ? all.rgb[3 * (row * static_cast<std::size_t>(all.width) + column) + k] : 150);
      }
    }
  }
  return image;
}

void draw_grid(figure::Image& image, const Window& window) {
  const auto lines = [&](int axis) {
    for (double at = kGridline * std::ceil(window.min[axis] / kGridline); at < window.max[axis];
         at += kGridline) {
      Vector2d from = window.min, to = window.max;
      from[axis] = to[axis] = at;
      const std::pair<double, double> corners[] = {window.pixel(from), window.pixel(to)};
      figure::draw_line(image, corners, figure::kWhite, 0.4);
    }
  };
  lines(0);
  lines(1);
}

}  // namespace

figure::Image map_picture(const behavior::MapReport& report) {
  const Window window = window_of(report);
  figure::Image image = cells_of(report.map, window);
  draw_grid(image, window);
  const auto draw = [&](const std::vector<Vector2d>& corners, figure::Color color,
                        double width_px) {
    std::vector<std::pair<double, double>> pixels;
    for (const Vector2d& at : corners) pixels.push_back(window.pixel(at));
    figure::draw_line(image, pixels, color, width_px);
  };
  draw(report.trail, figure::kBlue, 3);
  draw(report.path, figure::kWhite, 2);
  const auto [u, v] = window.pixel(report.goal);
  figure::draw_crosshair(image, u, v, 12, figure::kYellow, 3);
  const Vector2d ahead(std::cos(report.heading_rad), std::sin(report.heading_rad)),
      left(-ahead.y(), ahead.x());
  draw({report.robot - 0.04 * ahead + 0.04 * left, report.robot + 0.07 * ahead,
        report.robot - 0.04 * ahead - 0.04 * left, report.robot - 0.04 * ahead + 0.04 * left},
       figure::kBlack, 2.5);
  const char* const legend[] = {"green: floor, red: obstacle, grey: not seen; paler: less sure",
                                "blue: walked, white: path, yellow: goal; lines every 0.5 m"};
  for (int line = 0; line < 2; ++line)
    figure::draw_text(image, 6, image.height - 22 + 14 * line, legend[line], 11, figure::kWhite);
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
