// What counts as done, how sure a share is, and the table.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/walking/score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tools/figure/figure.h"
#include "tools/trials/statistics.h"

namespace kaz::walking {
namespace {

struct Line {
  int all = 0, done = 0, falls = 0;
  double low = 0, high = 0;
  // Of those that did not fall: by what they missed the goal.
  double mean = 0, sigma = 0, most = 0, seconds = 0, heading_sigma = 0, heading_most = 0;
};

double missed(const Trial& trial, const Outcome& out) {
  if (trial.judged == Judged::turn) return out.heading_deg - trial.turn_deg;
  return 1e3 * std::hypot(out.forward_m - trial.distance, out.aside_m);
}

Line line_of(const Trial& trial, const std::vector<Outcome>& outcomes) {
  Line line;
  line.all = static_cast<int>(outcomes.size());
  double sum = 0, squares = 0, headings = 0;
  for (const Outcome& out : outcomes) {
    line.done += succeeded(trial, out);
    line.falls += out.fell;
    if (out.fell) continue;
    const double miss = missed(trial, out);
    sum += miss;
    squares += miss * miss;
    headings += out.heading_deg * out.heading_deg;
    line.most = std::max(line.most, std::abs(miss));
    line.heading_most = std::max(line.heading_most, std::abs(out.heading_deg));
    line.seconds += out.seconds;
  }
  const auto interval =
      trials::wilson(static_cast<std::uint64_t>(line.done), static_cast<std::uint64_t>(line.all));
  line.low = interval.least;
  line.high = interval.most;
  const int stood = line.all - line.falls;
  if (stood == 0) return line;
  line.mean = sum / stood;
  line.sigma = std::sqrt(std::max(0.0, squares / stood - line.mean * line.mean));
  line.heading_sigma = std::sqrt(headings / stood);
  line.seconds /= stood;
  return line;
}

std::string text_of(const char* format, auto... values) {
  char text[200];
  std::snprintf(text, sizeof text, format, values...);
  return text;
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

std::string table(const gait::Results& results, const std::vector<Trial>& trials,
                  const std::string& variant) {
  std::ostringstream out;
  out << "| trial | done | 95 % interval | falls | missed, mean ± sigma | most | heading, rms / "
         "most, ° "
         "| time, s |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const Trial& trial : trials) {
    const auto outcomes = results.of(trial.name, variant);
    if (outcomes.empty()) continue;
    const Line line = line_of(trial, outcomes);
    const char* unit = trial.judged == Judged::turn ? "°" : " mm";
    out << "| " << trial.name
        << text_of(" | %d of %d | %.1f to %.1f %% | %d", line.done, line.all, 100 * line.low,
                   100 * line.high, line.falls);
    if (trial.judged == Judged::stand || trial.judged == Judged::get_up) {
      out << " |  |  |  |" << (trial.judged == Judged::stand ? "" : text_of(" %.1f", line.seconds))
          << " |\n";
      continue;
    }
    if (line.falls == line.all) {
      out << " |  |  |  |  |\n";
      continue;
    }
    out << text_of(" | %+.1f ± %.1f%s | %.1f%s | ", line.mean, line.sigma, unit, line.most, unit);
    if (trial.judged == Judged::walk)
      out << text_of("%.1f / %.1f", line.heading_sigma, line.heading_most);
    out << text_of(" | %.1f |\n", line.seconds);
    if (const int errors = results.errors(trial.name, variant); errors > 0)
      out << "|  | and " << errors << " that broke off |  |  |  |  |  |  |\n";
  }
  return out.str();
}

std::string odometry_table(const gait::Results& results, const std::vector<Trial>& trials,
                           const std::string& variant) {
  std::ostringstream out;
  for (const Trial& trial : trials) {
    if (trial.judged != Judged::walk) continue;
    // Along, across, heading.
    std::array<double, 3> sum{}, squares{}, sigmas{};
    int count = 0;
    for (const Outcome& one : results.of(trial.name, variant)) {
      if (one.fell || !one.figures.contains("ahead_m")) continue;
      const auto said = [&one](const char* name) { return one.figures.at(name); };
      const std::array<double, 3> off{said("ahead_m") - one.forward_m,
                                      said("aside_m") - one.aside_m,
                                      said("turned_deg") - one.heading_deg};
      const std::array<double, 3> sigma{said("sigma_along_m"), said("sigma_across_m"),
                                        said("sigma_heading_deg")};
      for (std::size_t i = 0; i < 3; ++i) {
        sum[i] += off[i];
        squares[i] += off[i] * off[i];
        sigmas[i] += off[i] * off[i] / (sigma[i] * sigma[i]);
      }
      ++count;
    }
    if (count == 0) continue;
    if (out.str().empty()) {
      out << "| walk | along, mm | in sigmas | across, mm | in sigmas | heading, ° | in sigmas |\n"
             "| --- | --- | --- | --- | --- | --- | --- |\n";
    }
    out << "| " << trial.name << " (" << count << ")";
    for (std::size_t i = 0; i < 3; ++i) {
      const double unit = i < 2 ? 1e3 : 1, mean = sum[i] / count;
      out << text_of(" | %+.1f ± %.1f | %.2f", unit * mean,
                     unit * std::sqrt(std::max(0.0, squares[i] / count - mean * mean)),
                     std::sqrt(sigmas[i] / count));
    }
    out << " |\n";
  }
  return out.str();
}

std::string summary_json(const gait::Results& results, const std::vector<Trial>& trials,
                         const std::string& variant) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Trial& trial : trials) {
    const auto outcomes = results.of(trial.name, variant);
    if (outcomes.empty()) continue;
    const Line line = line_of(trial, outcomes);
    all.push_back({{"trial", trial.name},
                   {"episodes", line.all},
                   {"success_rate", static_cast<double>(line.done) / line.all},
                   {"interval", {line.low, line.high}},
                   {"falls", line.falls},
                   {"broke_off", results.errors(trial.name, variant)},
                   {"missed_mean", line.mean},
                   {"missed_sigma", line.sigma},
                   {"missed_most", line.most},
                   {"heading_rms_deg", line.heading_sigma},
                   {"seconds", line.seconds}});
  }
  return all.dump(2) + "\n";
}

Result<void> pictures(const gait::Results& results, const std::string& variant,
                      const std::string& folder) {
  figure::PlotPage page;
  page.title = "One metre: paths of the trunk from above";
  page.x_label = "ahead, cm";
  page.plot_height_px = 190;
  for (const auto& [name, title] : {std::pair{"walk 1 m", "with the gyro"},
                                    {"walk 1 m, no gyro", "without: heading by strides"}}) {
    figure::LinePlot plot;
    plot.title = title;
    plot.y_label = "to the left, mm";
    figure::Series series;
    series.color = figure::kBlue;
    series.width_px = 0.8;
    for (const Outcome& out : results.of(name, variant)) {
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
