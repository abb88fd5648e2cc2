// Tables of the outcomes, by task and implementation of the dynamics.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/gait/report.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <nlohmann/json.hpp>

#include "tests/studies/common/table.h"
#include "tools/trials/statistics.h"

namespace kaz::gait {
namespace {

using studies::EpisodeFile;
using studies::text;
using trials::Summary;

// Statistics of a task under one dynamics. Those of motion are over the episodes without a fall.
struct Statistics {
  int runs = 0, errors = 0, falls = 0, caught = 0;
  Summary speed_cm, seconds, heading, abs_heading, aside_mm, tilt, displaced_mm, grasp_mm, hottest;
  Summary per_cycle;  // over seeds, of each seed's mean
  double within = 0;  // root mean square over seeds of sigma between a seed's cycles
};

Statistics statistics_of(const EpisodeFile& file, const Task& task, const std::string& dynamics) {
  const std::vector<Outcome> all = file.outcomes(task.name, dynamics);
  Statistics s;
  s.runs = static_cast<int>(all.size());
  s.errors = file.errors(task.name, dynamics);
  std::vector<Outcome> upright;
  for (const Outcome& out : all) {
    s.falls += out.fell;
    s.caught += out.caught;
    if (!out.fell) upright.push_back(out);
  }
  const auto over = [&upright](const std::function<double(const Outcome&)>& value) {
    std::vector<double> values;
    for (const Outcome& out : upright) values.push_back(value(out));
    return trials::summarize(values);
  };
  s.speed_cm = over([](const Outcome& o) { return 100 * o.forward_m / o.seconds; });
  s.seconds = over([](const Outcome& o) { return o.seconds; });
  s.heading = over([](const Outcome& o) { return o.heading_deg; });
  s.abs_heading = over([](const Outcome& o) { return std::abs(o.heading_deg); });
  s.aside_mm = over([](const Outcome& o) { return 1e3 * o.aside_m; });
  s.tilt = over([](const Outcome& o) { return o.tilt_deg; });
  s.hottest = over([](const Outcome& o) { return o.hottest_celsius; });
  s.displaced_mm = over([](const Outcome& o) {
    if (o.path.empty()) return 0.0;
    return std::hypot(o.path.back().first - o.path.front().first,
                      o.path.back().second - o.path.front().second);
  });
  std::vector<double> held, means;
  double squares = 0;
  for (const Outcome& out : upright) {
    if (out.caught) held.push_back(out.grasp_mm);
    if (out.per_cycle_deg.empty()) continue;
    const Summary one = trials::summarize(out.per_cycle_deg);
    means.push_back(one.mean);
    squares += one.sigma * one.sigma;
  }
  s.grasp_mm = trials::summarize(held);
  s.per_cycle = trials::summarize(means);
  if (!means.empty()) s.within = std::sqrt(squares / static_cast<double>(means.size()));
  return s;
}

struct Column {
  const char* title;
  std::function<std::string(const Statistics&)> value;
};

std::string mean_max(const char* format, const Summary& s) {
  return text(format, s.mean, s.max);
}
std::string mean_sigma(const char* format, const Summary& s) {
  return text(format, s.mean, s.sigma);
}

std::vector<Column> columns(Kind kind) {
  using S = Statistics;
  const Column time{"time, s", [](const S& s) { return text("%.1f", s.seconds.mean); }};
  switch (kind) {
    case Kind::walk:
      return {{"speed, cm/s", [](const S& s) { return text("%.2f", s.speed_cm.mean); }},
              {"heading error at the end, mean / max, °",
               [](const S& s) { return mean_max("%.2f / %.2f", s.abs_heading); }},
              {"heading, mean ± sigma, °",
               [](const S& s) { return mean_sigma("%+.2f ± %.2f", s.heading); }},
              {"lateral deviation, mean / max, mm",
               [](const S& s) { return mean_max("%.0f / %.0f", s.aside_mm); }},
              time};
    case Kind::turn:
      return {{"rotation, °", [](const S& s) { return mean_sigma("%+.1f ± %.1f", s.heading); }},
              {"displacement, mean / max, mm",
               [](const S& s) { return mean_max("%.0f / %.0f", s.displaced_mm); }},
              time};
    case Kind::spin:
      return {
          {"rotation a cycle, ± over seeds, °",
           [](const S& s) { return mean_sigma("%.1f ± %.1f", s.per_cycle); }},
          {"± between the cycles of a run, °", [](const S& s) { return text("%.1f", s.within); }}};
    case Kind::stand:
      return {
          {"max tilt, mean / max, °", [](const S& s) { return mean_max("%.1f / %.1f", s.tilt); }}};
    case Kind::grab:
      return {{"caught", [](const S& s) { return text("%d of %d", s.caught, s.runs); }},
              {"ball from the grasp's centre, mm",
               [](const S& s) { return mean_sigma("%.1f ± %.1f", s.grasp_mm); }}};
  }
  return {};
}

std::string table_of(Kind kind, const EpisodeFile& file, const std::vector<Task>& tasks,
                     const std::vector<std::string>& dynamics) {
  const std::vector<Column> shown = columns(kind);
  std::vector<std::string> heading{"task", "dynamics", "falls"};
  for (const Column& column : shown) heading.emplace_back(column.title);
  studies::MarkdownTable table(std::move(heading));
  for (const Task& task : tasks) {
    if (task.kind != kind) continue;
    bool any = false;
    for (const std::string& name : dynamics) {
      const Statistics s = statistics_of(file, task, name);
      if (s.runs + s.errors == 0) continue;
      any = true;
      std::vector<std::string> cells{task.name, name, text("%d of %d", s.falls, s.runs)};
      if (s.errors > 0) cells.back().append(text(", %d errors", s.errors));
      for (const Column& column : shown) cells.push_back(column.value(s));
      table.add(std::move(cells));
    }
    if (any && task.reference != "-") table.add({"", "reference", task.reference});
  }
  return table.empty() ? "" : table.text() + "\n";
}

}  // namespace

std::string tables(const EpisodeFile& file, const std::vector<Task>& tasks,
                   const std::vector<std::string>& dynamics) {
  std::string out;
  for (const Kind kind : {Kind::walk, Kind::turn, Kind::spin, Kind::stand, Kind::grab})
    out += table_of(kind, file, tasks, dynamics);
  return out;
}

std::string summary_json(const EpisodeFile& file, const std::vector<Task>& tasks,
                         const std::vector<std::string>& dynamics) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Task& task : tasks) {
    for (const std::string& name : dynamics) {
      const Statistics s = statistics_of(file, task, name);
      if (s.runs + s.errors == 0) continue;
      nlohmann::ordered_json row{{"task", task.name},  {"dynamics", name}, {"runs", s.runs},
                                 {"errors", s.errors}, {"falls", s.falls}, {"caught", s.caught}};
      const auto put = [&row](const char* key, const Summary& value) {
        row[key] = {{"mean", value.mean}, {"sigma", value.sigma}, {"max", value.max}};
      };
      put("speed_cm_per_s", s.speed_cm);
      put("seconds", s.seconds);
      put("heading_deg", s.heading);
      put("heading_error_deg", s.abs_heading);
      put("lateral_mm", s.aside_mm);
      put("displaced_mm", s.displaced_mm);
      put("tilt_deg", s.tilt);
      put("grasp_mm", s.grasp_mm);
      put("hottest_celsius", s.hottest);
      put("per_cycle_deg", s.per_cycle);
      row["within_run_deg"] = s.within;
      all.push_back(row);
    }
  }
  return all.dump(1) + "\n";
}

}  // namespace kaz::gait
