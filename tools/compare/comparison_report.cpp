// A comparison as text, JSON and plots.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "host/robot/posture.h"
#include "shared/base/angle.hpp"
#include "shared/base/counted.hpp"
#include "tools/base/output.h"
#include "tools/compare/comparison.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPoints = 1500;  // of a line in a plot

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, std::abs(value) >= 100 ? "%.0f" : "%.2f", value);
  return text;
}

// "12.30 +- 0.05", or "-" where it is not known.
std::string value_text(const Measured& value) {
  if (!value.known) return "-";
  std::string text = number(value.value);
  if (value.error > 0) text += " +- " + number(value.error);
  return text;
}

void print_measure(std::string& text, const Measure& measure, std::size_t width) {
  char line[240];
  const std::string apart =
      measure.comparable() ? (measure.difference() > 0 ? "+" : "") + number(measure.difference())
                           : "";
  std::snprintf(line, sizeof line, "%-22s %-4s %18s %18s %9s  ", measure.name.c_str(),
                measure.unit.c_str(), value_text(measure.a).c_str(), value_text(measure.b).c_str(),
                apart.c_str());
  text += list_row(line, measure.left_out.empty() ? measure.meaning : measure.left_out, width);
}

Json measured_json(const Measured& value) {
  return {{"value", value.value}, {"standard_error", value.error}};
}

Json run_json(const RunTrace& run) {
  return {{"file", run.name},
          {"behavior", run.behavior},
          {"robot", run.robot},
          {"duration_s", run.duration_s},
          {"postures", run.postures.size()},
          {"pictures", run.pictures.size()},
          {"shutdowns", run.shutdowns}};
}

plot::Series thinned(const std::string& label, plot::Color color, const std::vector<double>& x,
                     const std::vector<double>& y, plot::Series::Style style) {
  plot::Series series;
  series.label = label;
  series.color = color;
  series.style = style;
  const std::size_t step = std::max<std::size_t>(1, x.size() / kMostPoints);
  for (std::size_t i = 0; i < x.size(); i += step) {
    series.x.push_back(x[i]);
    series.y.push_back(y[i]);
  }
  return series;
}

// A value of each item of a run over its time.
template <class Item, class Time, class Value>
plot::Series series_of(const std::string& label, plot::Color color, const std::vector<Item>& items,
                       Time time, Value value, plot::Series::Style style) {
  std::vector<double> x, y;
  for (const Item& item : items) {
    if (time(item) < 0) continue;
    x.push_back(time(item));
    y.push_back(value(item));
  }
  return thinned(label, color, x, y, style);
}

plot::Series angle_series(const std::string& label, plot::Color color, const RunTrace& run,
                          int joint) {
  return series_of(
      label, color, run.postures, [](const auto& one) { return one.time_s; },
      [joint](const auto& one) { return one.angle_rad[static_cast<std::size_t>(joint)] / kDegree; },
      plot::Series::Style::line);
}

plot::LinePlot joint_plot(const RunTrace& a, const RunTrace& b, int joint) {
  const char* name = host::joint_table()[static_cast<std::size_t>(joint)].name;
  plot::LinePlot plot;
  plot.title = name;
  plot.y_label = "degrees";
  if (const CommandCurve command = command_curve(a, joint); !command.angle_rad.empty()) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < command.angle_rad.size(); ++i) {
      x.push_back(command.start_s + 1e-3 * static_cast<double>(i));
      y.push_back(command.angle_rad[i] / kDegree);
    }
    plot.series.push_back(thinned("command of A", plot::kGrey, x, y, plot::Series::Style::dashed));
  }
  plot.series.push_back(angle_series("A", plot::kBlue, a, joint));
  plot.series.push_back(angle_series("B", plot::kOrange, b, joint));
  return plot;
}

bool moved(const RunTrace& run, int joint) {
  const CommandCurve command = command_curve(run, joint);
  if (command.angle_rad.empty()) return false;
  const auto [low, high] = std::ranges::minmax(command.angle_rad);
  return high - low > 2 * kDegree;
}

template <class Value>
plot::LinePlot both(const char* title, const char* unit, const RunTrace& a, const RunTrace& b,
                    Value series) {
  plot::LinePlot plot;
  plot.title = title;
  plot.y_label = unit;
  plot.series.push_back(series("A", plot::kBlue, a));
  plot.series.push_back(series("B", plot::kOrange, b));
  return plot;
}

}  // namespace

std::string comparison_text(const Comparison& comparison, const RunTrace& a, const RunTrace& b,
                            bool all, std::size_t width) {
  std::string text;
  char line[400];
  for (const auto& [letter, run] : {std::pair{"A", &a}, std::pair{"B", &b}}) {
    std::snprintf(line, sizeof line, "%s  %s: %s, %s, %.1f s, %zu postures, %zu pictures\n", letter,
                  run->name.c_str(), run->behavior.empty() ? "?" : run->behavior.c_str(),
                  run->robot == "virtual" ? "virtual robot" : run->robot.c_str(), run->duration_s,
                  run->postures.size(), run->pictures.size());
    text += line;
  }
  for (const std::string& note : comparison.notes) text += "note: " + note + "\n";
  const int differing = comparison.differing();
  const auto comparable = std::ranges::count_if(comparison.measures, &Measure::comparable);
  std::snprintf(line, sizeof line, "%d of %d measures differ by more than their noise%s\n",
                differing, static_cast<int>(comparable),
                all || differing == 0 ? "" : " (--all shows the others)");
  text += line;
  const auto left_out = std::ranges::count_if(
      comparison.measures, [](const Measure& measure) { return !measure.left_out.empty(); });
  if (left_out > 0 && !all)
    text += counted(left_out, "lag") +
            " left out, because these motions are unsuitable (--all gives the reason)\n";
  if (!all && differing == 0) return text;
  std::snprintf(line, sizeof line, "\n%-22s %-4s %18s %18s %9s\n", "measure", "unit", "A", "B",
                "B - A");
  text += line;
  for (const Measure& measure : comparison.measures)
    if (measure.differs()) print_measure(text, measure, width);
  if (!all) return text;
  text +=
      "\n"
      "measures that do not differ, and measures that are not comparable:\n";
  for (const Measure& measure : comparison.measures)
    if (!measure.differs()) print_measure(text, measure, width);
  return text;
}

Json comparison_json(const Comparison& comparison, const RunTrace& a, const RunTrace& b) {
  Json json{{"a", run_json(a)},
            {"b", run_json(b)},
            {"differing", comparison.differing()},
            {"same_targets_s", comparison.same_targets_s},
            {"notes", comparison.notes}};
  for (const Measure& measure : comparison.measures) {
    Json one{{"name", measure.name}, {"unit", measure.unit}, {"meaning", measure.meaning}};
    if (!measure.left_out.empty()) one["left_out"] = measure.left_out;
    // What was not measured is absent.
    if (measure.a.known) one["a"] = measured_json(measure.a);
    if (measure.b.known) one["b"] = measured_json(measure.b);
    if (measure.comparable()) {
      one["difference"] = measure.difference();
      one["threshold"] = measure.threshold();
      one["differs"] = measure.differs();
    }
    json["measures"].push_back(one);
  }
  return json;
}

std::vector<plot::PlotPage> comparison_plots(const RunTrace& a, const RunTrace& b) {
  plot::PlotPage joints;
  joints.title = "Joints";
  joints.x_label = "time, s";
  for (int j = 0; j < KZ_JOINTS; ++j)
    if (moved(a, j) || moved(b, j)) joints.plots.push_back(joint_plot(a, b, j));
  joints.plot_height_px = 180;
  plot::PlotPage rest;
  rest.title = "Supply, link, pictures";
  rest.x_label = "time, s";
  rest.plots.push_back(
      both("supply", "V", a, b, [](const char* label, plot::Color color, const RunTrace& run) {
        return series_of(
            label, color, run.postures, [](const auto& one) { return one.time_s; },
            [](const auto& one) { return one.supply_v; }, plot::Series::Style::line);
      }));
  rest.plots.push_back(
      both("round trip", "ms", a, b, [](const char* label, plot::Color color, const RunTrace& run) {
        return series_of(
            label, color, run.exchanges, [](const auto& one) { return one.time_s; },
            [](const auto& one) { return one.round_trip_s * 1e3; }, plot::Series::Style::points);
      }));
  if (!a.pictures.empty() || !b.pictures.empty())
    rest.plots.push_back(
        both("time from exposure to the vision result", "ms", a, b,
             [](const char* label, plot::Color color, const RunTrace& run) {
               return series_of(
                   label, color, run.pictures, [](const auto& one) { return one.exposure_s; },
                   [](const auto& one) { return one.delay_s * 1e3; }, plot::Series::Style::points);
             }));
  std::vector<plot::PlotPage> pages;
  if (!joints.plots.empty()) pages.push_back(std::move(joints));
  pages.push_back(std::move(rest));
  return pages;
}

}  // namespace kaz::tools
