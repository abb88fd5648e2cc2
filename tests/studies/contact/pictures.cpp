// Side views of three tosses: outlines of the measured and the simulated cube.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "shared/base/files.hpp"
#include "shared/plot/svg.h"
#include "tests/studies/common/table.h"
#include "tests/studies/contact/report.h"

namespace kaz::contact {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr int kWidth_px = 720;
constexpr double kBeside_px = 84, kAbove_px = 60;  // page around the frame of a plot (layout.cpp)
constexpr std::size_t kOutlines = 7;               // poses in a picture, evenly in time

// One half of a convex hull, from left to right: a chain that turns left only (Andrew 1979).
void add_half_hull(const Points& sorted, Points& hull) {
  const std::size_t first = hull.size();
  const auto turns_right = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d a = hull.back() - hull[hull.size() - 2], b = p - hull.back();
    return a.x() * b.y() - a.y() * b.x() <= 0;
  };
  for (const Eigen::Vector2d& p : sorted) {
    while (hull.size() >= first + 2 && turns_right(p)) hull.pop_back();
    hull.push_back(p);
  }
}

// Closed outline of the cube, seen against `along` x z: horizontal direction and up, cm.
Points outline_of(const Pose& pose, const Eigen::Vector3d& along) {
  Points corners;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d own((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    const Eigen::Vector3d corner = pose.at + pose.turn * (kHalf * own);
    corners.emplace_back(100 * along.dot(corner), 100 * corner.z());
  }
  const auto left = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  std::ranges::sort(corners, left);
  Points hull;
  add_half_hull(corners, hull);
  std::ranges::reverse(corners);
  add_half_hull(corners, hull);
  return hull;
}

plot::Series outlines_of(const Path& path, const Eigen::Vector3d& along, const std::string& label,
                         plot::Color color) {
  plot::Series series{label, color, {}, {}, 1.4};
  for (std::size_t k = 0; k < kOutlines; ++k) {
    for (const Eigen::Vector2d& p :
         outline_of(path[k * (path.size() - 1) / (kOutlines - 1)], along)) {
      series.x.push_back(p.x());
      series.y.push_back(p.y());
    }
    series.x.push_back(std::numeric_limits<double>::quiet_NaN());
    series.y.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  return series;
}

// Chooses the height so that both axes have the same scale.
void set_height(plot::PlotPage& page) {
  const auto range_of = [&](auto member) {
    double low = 1e9, high = -1e9;
    for (const plot::LinePlot& plot : page.plots)
      for (const plot::Series& series : plot.series)
        for (const double v : series.*member) {
          if (std::isnan(v)) continue;
          low = std::min(low, v);
          high = std::max(high, v);
        }
    return std::pair{low, high};
  };
  const auto [left, right] = range_of(&plot::Series::x);
  const auto [low, high] = range_of(&plot::Series::y);
  for (plot::LinePlot& plot : page.plots) {
    plot.y_min = low - 1;
    plot.y_max = high + 1;
  }
  const double scale = (kWidth_px - kBeside_px) / (right - left);
  page.plot_height_px = static_cast<int>(std::lround(kAbove_px + scale * (high - low + 2)));
}

Result<plot::PlotPage> page_of(std::span<const Row> rows, const Toss& toss, std::size_t number) {
  Eigen::Vector3d along = toss.path.back().at - toss.path.front().at;
  along.z() = 0;
  along = along.norm() > 1e-6 ? along.normalized() : Eigen::Vector3d::UnitX();
  plot::PlotPage page;
  page.title = "Toss " + std::to_string(toss.number);
  page.x_label = "along the toss, cm";
  page.width_px = kWidth_px;
  for (const Row& row : rows) {
    const Path path = KAZ_TRY(row.engine.simulate(toss, values_for(row, toss)));
    plot::LinePlot plot;
    plot.title = row.engine.name + studies::text(", error %.3f", row.judged.errors[number]);
    plot.y_label = "height, cm";
    plot.series = {outlines_of(toss.path, along, "measured", plot::kBlue),
                   outlines_of(path, along, "simulated", plot::kRed)};
    page.plots.push_back(std::move(plot));
  }
  set_height(page);
  return page;
}

}  // namespace

Result<void> write_pictures(const std::string& folder, std::span<const Row> rows,
                            std::span<const Toss> tosses) {
  if (rows.empty() || tosses.empty()) return {};
  std::vector<std::size_t> order(tosses.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return rows[0].judged.errors[i]; });
  // The first and the last row: Kaz's default engine and the judge.
  std::vector<Row> shown{rows.front()};
  if (rows.size() > 1) shown.push_back(rows.back());
  for (const std::size_t percent : {10, 50, 90}) {
    const std::size_t i = order[percent * (order.size() - 1) / 100];
    const auto page = KAZ_TRY(page_of(shown, tosses[i], i));
    KAZ_TRY(write_whole_file(folder + "/toss-" + std::to_string(percent) + ".svg",
                             plot::plot_svg(page)));
  }
  return {};
}

}  // namespace kaz::contact
