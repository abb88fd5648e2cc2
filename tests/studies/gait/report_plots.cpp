// Plots of the outcomes: trunk paths, and histograms of the rotation.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/studies/gait/report.h"
#include "tools/drawing/figure.h"

namespace kaz::gait {
namespace {

using figure::Color;

Color color_of(std::size_t curve) {
  constexpr Color colors[] = {figure::kBlue, figure::kRed, figure::kGreen, figure::kPurple};
  return colors[curve % std::size(colors)];
}

// All episodes in one series, separated by NaN.
figure::Series paths_of(const std::vector<Outcome>& outcomes) {
  figure::Series series;
  for (const Outcome& out : outcomes) {
    for (const auto& [x, y] : out.path) {
      series.x.push_back(x / 10);
      series.y.push_back(y);
    }
    series.x.push_back(series.x.empty() ? 0 : series.x.back());
    series.y.push_back(std::nan(""));
  }
  return series;
}

// Percentage of the values in each degree, as a step curve.
figure::Series histogram(const std::vector<double>& values, double low, double high) {
  figure::Series series;
  for (double from = std::floor(low); from < high; from += 1) {
    const auto count = std::ranges::count_if(
        values, [from](double value) { return value >= from && value < from + 1; });
    const double share = 100.0 * static_cast<double>(count) / static_cast<double>(values.size());
    for (const double x : {from, from + 1}) {
      series.x.push_back(x);
      series.y.push_back(share);
    }
  }
  return series;
}

}  // namespace

Result<void> write_plots(const studies::EpisodeFile& file, const std::vector<Task>& tasks,
                         const std::vector<std::string>& dynamics, const std::string& folder) {
  figure::PlotPage walks, turns;
  walks.title = "Paths of the trunk from above";
  walks.x_label = "ahead, cm";
  turns.title = "Rotation of the episodes without a fall";
  turns.x_label = "rotation, degrees (rows of 3 cycles: of each cycle)";
  walks.plot_height_px = turns.plot_height_px = 170;
  for (const Task& task : tasks) {
    const bool walks_task = task.kind == Kind::walk;
    const bool turns_task = task.kind == Kind::turn || task.kind == Kind::spin;
    if (!walks_task && !turns_task) continue;
    figure::LinePlot plot;
    plot.title = task.name;
    plot.y_label = walks_task                ? "to the left, mm"
                   : task.kind == Kind::spin ? "cycles, %"
                                             : "runs, %";
    for (std::size_t s = 0; s < dynamics.size(); ++s) {
      const std::vector<Outcome> outcomes = file.outcomes(task.name, dynamics[s]);
      std::vector<double> turned;
      for (const Outcome& out : outcomes) {
        if (out.fell) continue;
        if (task.kind == Kind::turn) turned.push_back(std::abs(out.heading_deg));
        turned.insert(turned.end(), out.per_cycle_deg.begin(), out.per_cycle_deg.end());
      }
      if (outcomes.empty() || (turns_task && turned.empty())) continue;
      const auto [low, high] = std::ranges::minmax(turned.empty() ? std::vector{0.0} : turned);
      figure::Series series =
          walks_task ? paths_of(outcomes) : histogram(turned, low - 2, high + 2);
      series.label = dynamics[s];
      series.color = color_of(s);
      series.width_px = walks_task ? 0.8 : 1.8;
      plot.series.push_back(std::move(series));
    }
    if (!plot.series.empty()) (walks_task ? walks : turns).plots.push_back(std::move(plot));
  }
  for (const auto& [page, name] : {std::pair{&walks, "gait_paths"}, {&turns, "gait_turns"}}) {
    if (page->plots.empty()) continue;
    if (auto written = figure::write_plot_svg(folder + "/" + name + ".svg", *page); !written)
      return written;
    if (auto written = figure::write_plot_png(folder + "/" + name + ".png", *page); !written)
      return written;
  }
  return {};
}

}  // namespace kaz::gait
