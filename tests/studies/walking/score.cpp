// Success criterion, success rates with confidence intervals, and tables.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/walking/score.h"

#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "tests/studies/common/table.h"
#include "tools/drawing/figure.h"
#include "tools/trials/statistics.h"

namespace kaz::walking {
namespace {

using studies::EpisodeFile;
using studies::text;

struct Score {
  int episodes = 0, successes = 0, falls = 0;
  trials::Interval interval;  // of the success rate
  // Of the episodes without a fall. Error: mm from the goal, or degrees of a turn.
  trials::Errors error, heading_deg;
  double seconds = 0;  // mean
};

double goal_error(const Trial& trial, const Outcome& out) {
  if (trial.judged == Judged::turn) return out.heading_deg - trial.turn_deg;
  return 1e3 * std::hypot(out.forward_m - trial.distance, out.aside_m);
}

Score score_of(const Trial& trial, const std::vector<Outcome>& outcomes) {
  Score score;
  score.episodes = static_cast<int>(outcomes.size());
  for (const Outcome& out : outcomes) {
    score.successes += succeeded(trial, out);
    score.falls += out.fell;
    if (out.fell) continue;
    score.error.add(goal_error(trial, out));
    score.heading_deg.add(out.heading_deg);
    score.seconds += out.seconds;
  }
  score.interval = trials::wilson(static_cast<std::uint64_t>(score.successes),
                                  static_cast<std::uint64_t>(score.episodes));
  if (!score.error.empty()) score.seconds /= static_cast<double>(score.error.count());
  return score;
}

}  // namespace

bool succeeded(const Trial& trial, const Outcome& out) {
  if (out.fell) return false;
  switch (trial.judged) {
    case Judged::walk:
      return std::hypot(out.forward_m - trial.distance, out.aside_m) <= 0.1 * trial.distance &&
             std::abs(out.heading_deg) <= 8;
    case Judged::turn:
      return std::abs(out.heading_deg - trial.turn_deg) <= 6;
    default:
      return true;
  }
}

std::string table(const EpisodeFile& file, const std::vector<Trial>& all_trials,
                  const std::string& mcu) {
  studies::MarkdownTable table({"trial", "success", "95 % interval", "falls", "error, mean ± sigma",
                                "max", "heading, rms / max, °", "time, s"});
  for (const Trial& trial : all_trials) {
    const auto outcomes = file.outcomes(trial.name, mcu);
    if (outcomes.empty()) continue;
    const Score s = score_of(trial, outcomes);
    const char* unit = trial.judged == Judged::turn ? "°" : " mm";
    const bool moves = trial.judged == Judged::walk || trial.judged == Judged::turn;
    std::vector<std::string> cells{
        trial.name, text("%d of %d", s.successes, s.episodes),
        text("%.1f to %.1f %%", 100 * s.interval.min, 100 * s.interval.max),
        std::to_string(s.falls)};
    cells.resize(8);
    if (moves && !s.error.empty()) {
      cells[4] = text("%+.1f ± %.1f%s", s.error.mean(), s.error.sigma(), unit);
      cells[5] = text("%.1f%s", s.error.max(), unit);
      if (trial.judged == Judged::walk)
        cells[6] = text("%.1f / %.1f", s.heading_deg.rms(), s.heading_deg.max());
    }
    if (trial.judged == Judged::get_up || (moves && !s.error.empty()))
      cells[7] = text("%.1f", s.seconds);
    table.add(std::move(cells));
    if (const int errors = file.errors(trial.name, mcu); errors > 0)
      table.add({"", text("and %d aborted", errors)});
  }
  return table.text();
}

std::string odometry_table(const EpisodeFile& file, const std::vector<Trial>& all_trials,
                           const std::string& mcu) {
  studies::MarkdownTable table(
      {"walk", "along, mm", "in sigmas", "across, mm", "in sigmas", "heading, °", "in sigmas"});
  for (const Trial& trial : all_trials) {
    if (trial.judged != Judged::walk) continue;
    // Along, across, heading.
    std::array<trials::Errors, 3> errors, normalized;
    for (const Outcome& one : file.outcomes(trial.name, mcu)) {
      if (one.fell || !one.reported.contains("ahead_m")) continue;
      const auto reported = [&one](const char* name) { return one.reported.at(name); };
      const std::array<double, 3> off{reported("ahead_m") - one.forward_m,
                                      reported("aside_m") - one.aside_m,
                                      reported("turned_deg") - one.heading_deg};
      const std::array<double, 3> sigma{reported("sigma_along_m"), reported("sigma_across_m"),
                                        reported("sigma_heading_deg")};
      for (std::size_t i = 0; i < 3; ++i) {
        errors[i].add(off[i]);
        normalized[i].add(off[i] / sigma[i]);
      }
    }
    if (errors[0].empty()) continue;
    std::vector<std::string> cells{text("%s (%zu)", trial.name.c_str(), errors[0].count())};
    for (std::size_t i = 0; i < 3; ++i) {
      const double unit = i < 2 ? 1e3 : 1;
      cells.push_back(text("%+.1f ± %.1f", unit * errors[i].mean(), unit * errors[i].sigma()));
      cells.push_back(text("%.2f", normalized[i].rms()));
    }
    table.add(std::move(cells));
  }
  return table.empty() ? "" : table.text();
}

std::string summary_json(const EpisodeFile& file, const std::vector<Trial>& all_trials,
                         const std::string& mcu) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Trial& trial : all_trials) {
    const auto outcomes = file.outcomes(trial.name, mcu);
    if (outcomes.empty()) continue;
    const Score s = score_of(trial, outcomes);
    rows.push_back({{"trial", trial.name},
                    {"episodes", s.episodes},
                    {"success_rate", static_cast<double>(s.successes) / s.episodes},
                    {"interval", {s.interval.min, s.interval.max}},
                    {"falls", s.falls},
                    {"aborted", file.errors(trial.name, mcu)},
                    {"error_mean", s.error.mean()},
                    {"error_sigma", s.error.sigma()},
                    {"error_max", s.error.max()},
                    {"heading_rms_deg", s.heading_deg.rms()},
                    {"seconds", s.seconds}});
  }
  return rows.dump(2) + "\n";
}

Result<void> write_plots(const EpisodeFile& file, const std::string& mcu,
                         const std::string& folder) {
  figure::PlotPage page;
  page.title = "One metre: paths of the trunk from above";
  page.x_label = "ahead, cm";
  page.plot_height_px = 190;
  for (const auto& [name, title] :
       {std::pair{"walk 1 m", "with the gyro"},
        {"walk 1 m, no gyro", "without gyro: heading from the strides"}}) {
    figure::LinePlot plot;
    plot.title = title;
    plot.y_label = "to the left, mm";
    figure::Series series;
    series.color = figure::kBlue;
    series.width_px = 0.8;
    for (const Outcome& out : file.outcomes(name, mcu)) {
      for (const auto& [x, y] : out.path) {
        series.x.push_back(x / 10);
        series.y.push_back(y);
      }
      series.x.push_back(series.x.empty() ? 0 : series.x.back());
      series.y.push_back(std::nan(""));
    }
    if (series.x.empty()) continue;
    plot.series.push_back(std::move(series));
    page.plots.push_back(std::move(plot));
  }
  if (page.plots.empty()) return {};
  if (auto written = figure::write_plot_svg(folder + "/walking_paths.svg", page); !written)
    return written;
  return figure::write_plot_png(folder + "/walking_paths.png", page);
}

}  // namespace kaz::walking
