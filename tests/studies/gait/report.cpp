// Tables of the outcomes, steppers side by side.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/gait/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>

#include <nlohmann/json.hpp>

namespace kaz::gait {
namespace {

std::string text(const char* format, auto... values) {
  char line[200];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

struct Spread {
  double mean = 0, sigma = 0, most = 0;
};

Spread spread(const std::vector<double>& values) {
  Spread out;
  if (values.empty()) return out;
  const auto count = static_cast<double>(values.size());
  out.mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  for (const double value : values) out.sigma += std::pow(value - out.mean, 2);
  out.sigma = values.size() > 1 ? std::sqrt(out.sigma / (count - 1)) : 0;
  out.most = *std::max_element(values.begin(), values.end());
  return out;
}

// All figures of a task under a stepper. Those of motion are of the runs that did not fall.
struct Figures {
  int runs = 0, errors = 0, falls = 0, caught = 0;
  Spread speed_cm, seconds, heading, off_heading, aside_mm, tilt, away_mm, grasp_mm, hottest;
  Spread per_cycle;   // over seeds, of each seed's mean
  double within = 0;  // root mean square over seeds of the scatter between a seed's cycles
};

Figures figures_of(const Results& results, const Task& task, const std::string& stepper) {
  const std::vector<Outcome> all = results.of(task.name, stepper);
  Figures f;
  f.runs = static_cast<int>(all.size());
  f.errors = results.errors(task.name, stepper);
  std::vector<Outcome> upright;
  for (const Outcome& out : all) {
    f.falls += out.fell;
    f.caught += out.caught;
    if (!out.fell) upright.push_back(out);
  }
  const auto over = [&upright](const std::function<double(const Outcome&)>& value) {
    std::vector<double> values;
    for (const Outcome& out : upright) values.push_back(value(out));
    return spread(values);
  };
  f.speed_cm = over([](const Outcome& o) { return 100 * o.forward_m / o.seconds; });
  f.seconds = over([](const Outcome& o) { return o.seconds; });
  f.heading = over([](const Outcome& o) { return o.heading_deg; });
  f.off_heading = over([](const Outcome& o) { return std::abs(o.heading_deg); });
  f.aside_mm = over([](const Outcome& o) { return 1e3 * o.aside_m; });
  f.tilt = over([](const Outcome& o) { return o.tilt_deg; });
  f.hottest = over([](const Outcome& o) { return o.hottest_celsius; });
  f.away_mm = over([](const Outcome& o) {
    if (o.path.empty()) return 0.0;
    return std::hypot(o.path.back().first - o.path.front().first,
                      o.path.back().second - o.path.front().second);
  });
  std::vector<double> held, means;
  double squares = 0;
  for (const Outcome& out : upright) {
    if (out.caught) held.push_back(out.grasp_mm);
    if (out.per_cycle_deg.empty()) continue;
    const Spread one = spread(out.per_cycle_deg);
    means.push_back(one.mean);
    squares += one.sigma * one.sigma;
  }
  f.grasp_mm = spread(held);
  f.per_cycle = spread(means);
  if (!means.empty()) f.within = std::sqrt(squares / static_cast<double>(means.size()));
  return f;
}

struct Column {
  const char* title;
  std::function<std::string(const Figures&)> value;
};

std::vector<Column> columns(Kind kind) {
  const Column time{"time, s", [](const Figures& f) { return text("%.1f", f.seconds.mean); }};
  switch (kind) {
    case Kind::walk:
      return {
          {"speed, cm/s", [](const Figures& f) { return text("%.2f", f.speed_cm.mean); }},
          {"heading at the end, off by mean / most, °",
           [](const Figures& f) {
             return text("%.2f / %.2f", f.off_heading.mean, f.off_heading.most);
           }},
          {"heading, mean ± sigma, °",
           [](const Figures& f) { return text("%+.2f ± %.2f", f.heading.mean, f.heading.sigma); }},
          {"aside mean / most, mm",
           [](const Figures& f) { return text("%.0f / %.0f", f.aside_mm.mean, f.aside_mm.most); }},
          time};
    case Kind::turn:
      return {
          {"turned, °",
           [](const Figures& f) { return text("%+.1f ± %.1f", f.heading.mean, f.heading.sigma); }},
          {"displaced mean / most, mm",
           [](const Figures& f) { return text("%.0f / %.0f", f.away_mm.mean, f.away_mm.most); }},
          time};
    case Kind::spin:
      return {{"a cycle ± over seeds, °",
               [](const Figures& f) {
                 return text("%.1f ± %.1f", f.per_cycle.mean, f.per_cycle.sigma);
               }},
              {"± between the cycles of a run, °",
               [](const Figures& f) { return text("%.1f", f.within); }}};
    case Kind::stand:
      return {{"largest tilt mean / most, °",
               [](const Figures& f) { return text("%.1f / %.1f", f.tilt.mean, f.tilt.most); }}};
    case Kind::grab:
      return {{"caught", [](const Figures& f) { return text("%d of %d", f.caught, f.runs); }},
              {"ball from the grasp's centre, mm", [](const Figures& f) {
                 return text("%.1f ± %.1f", f.grasp_mm.mean, f.grasp_mm.sigma);
               }}};
  }
  return {};
}

}  // namespace

std::string tables(const Results& results, const std::vector<Task>& tasks,
                   const std::vector<std::string>& steppers) {
  std::string out;
  const auto line = [](std::string& to, const std::vector<std::string>& cells) {
    for (const std::string& cell : cells) to.append("| ").append(cell).append(" ");
    to.append("|\n");
  };
  for (const Kind kind : {Kind::walk, Kind::turn, Kind::spin, Kind::stand, Kind::grab}) {
    const std::vector<Column> shown = columns(kind);
    std::vector<std::string> head{"task", "stepper", "falls"};
    for (const Column& column : shown) head.emplace_back(column.title);
    std::string rows;
    for (const Task& task : tasks) {
      if (task.kind != kind) continue;
      bool any = false;
      for (const std::string& stepper : steppers) {
        const Figures f = figures_of(results, task, stepper);
        if (f.runs + f.errors == 0) continue;
        any = true;
        std::vector<std::string> cells{task.name, stepper, text("%d of %d", f.falls, f.runs)};
        if (f.errors > 0) cells.back().append(text(", %d errors", f.errors));
        for (const Column& column : shown) cells.push_back(column.value(f));
        line(rows, cells);
      }
      std::vector<std::string> found(head.size());
      found[1] = "where found";
      found[2] = task.reference;
      if (any && task.reference != "-") line(rows, found);
    }
    if (rows.empty()) continue;
    line(out, head);
    line(out, std::vector<std::string>(head.size(), "---"));
    out.append(rows).append("\n");
  }
  return out;
}

std::string summary_json(const Results& results, const std::vector<Task>& tasks,
                         const std::vector<std::string>& steppers) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Task& task : tasks) {
    for (const std::string& stepper : steppers) {
      const Figures f = figures_of(results, task, stepper);
      if (f.runs + f.errors == 0) continue;
      nlohmann::ordered_json row{{"task", task.name},  {"stepper", stepper}, {"runs", f.runs},
                                 {"errors", f.errors}, {"falls", f.falls},   {"caught", f.caught}};
      const auto put = [&row](const char* name, const Spread& s) {
        row[name] = {{"mean", s.mean}, {"sigma", s.sigma}, {"most", s.most}};
      };
      put("speed_cm_per_s", f.speed_cm);
      put("seconds", f.seconds);
      put("heading_deg", f.heading);
      put("off_heading_deg", f.off_heading);
      put("aside_mm", f.aside_mm);
      put("displaced_mm", f.away_mm);
      put("tilt_deg", f.tilt);
      put("grasp_mm", f.grasp_mm);
      put("hottest_celsius", f.hottest);
      put("per_cycle_deg", f.per_cycle);
      row["within_run_deg"] = f.within;
      all.push_back(row);
    }
  }
  return all.dump(1) + "\n";
}

}  // namespace kaz::gait
