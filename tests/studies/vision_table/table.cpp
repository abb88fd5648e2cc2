// Markdown and JSON of the tables.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/vision_table/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace kaz::vision_table {
namespace {

const char* name_of(Sight sight) {
  switch (sight) {
    case Sight::whole:
      return "whole";
    case Sight::cut:
      return "cut by the edge of the picture";
    case Sight::hidden:
      return "hidden in part";
  }
  return "";
}

template <class... T>
std::string text(const char* format, T... values) {
  char line[512];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

double percent(int part, int all) {
  return all > 0 ? 100.0 * part / all : 0;
}

std::string accuracy_text(const std::vector<AccuracyRow>& rows) {
  std::string out;
  int width = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const AccuracyRow& r = rows[i];
    if (i == 0 || r.sight != rows[i - 1].sight || r.width != width) {
      width = r.width;
      out += text("\nBall %s, %d x %d, %d pictures a row:\n\n", name_of(r.sight), r.width,
                  r.width * 3 / 4, r.pictures);
      out +=
          "| distance | found | centre rms, 95 % | distance rms, 95 % | mean |\n"
          "|---|---|---|---|---|\n";
    }
    out +=
        text("| %.2f m | %.1f %%%s | %.2f, %.2f px | %.1f, %.1f %% | %+.1f %% |\n", r.distance_m,
             percent(r.found, r.pictures), r.wrong > 0 ? text(", %d wrong", r.wrong).c_str() : "",
             r.center_px.rms(), r.center_px.percentile(0.95), 100 * r.distance.rms(),
             100 * r.distance.percentile(0.95), 100 * r.distance.bias());
  }
  return out;
}

std::string robustness(const std::vector<RobustRow>& rows) {
  if (rows.empty()) return "";
  std::string out, group;
  int width = 0;
  for (const RobustRow& r : rows) {
    if (r.width != width) {
      out += text(
          "\nBall at 0.25 to 1 m, depth and floor, %d x %d; a row has up to %d pictures with a ",
          r.width, r.width * 3 / 4, r.balls);
      out += text("ball, %d without, %d pairs:\n\n", r.without, r.floors);
      out +=
          "| | ball found | wrong, false | centre rms | distance 95 % | depth right, known | floor "
          "found | normal, height 95 % |\n|---|---|---|---|---|---|---|---|\n";
      group.clear();
    }
    width = r.width;
    if (r.group != group) out += "| **" + r.group + "** | | | | | | | |\n";
    group = r.group;
    out += "| " + r.name;
    if (r.balls > 0) {
      out += text(" | %.0f %% | %.0f, %.0f %%", percent(r.found, r.balls),
                  percent(r.wrong, r.balls), percent(r.false_finds, r.without));
      out += r.found > 0 ? text(" | %.2f px | %.1f %%", r.center_px.rms(),
                                100 * r.distance.percentile(0.95))
                         : " | | ";
    } else {
      out += " | | | | ";
    }
    if (r.floors > 0) {
      out += r.textured > 0 ? text(" | %.0f, %.0f %%", percent(r.good, r.textured),
                                   percent(r.known, r.textured))
                            : std::string(" | no texture");
      out += text(" | %.0f %%", percent(r.floors_found, r.floors));
      out += r.floors_found > 0 ? text(" | %.1f°, %.1f mm", r.normal_deg.percentile(0.95),
                                       r.height_mm.percentile(0.95))
                                : " | ";
    } else {
      out += " | | | ";
    }
    out += " |\n";
  }
  return out;
}

}  // namespace

double Errors::rms() const {
  double sum = 0;
  for (const double v : values_) sum += v * v;
  return values_.empty() ? 0 : std::sqrt(sum / static_cast<double>(values_.size()));
}

double Errors::bias() const {
  double sum = 0;
  for (const double v : values_) sum += v;
  return values_.empty() ? 0 : sum / static_cast<double>(values_.size());
}

double Errors::percentile(double share) const {
  if (values_.empty()) return 0;
  std::vector<double> sizes;
  for (const double v : values_) sizes.push_back(std::abs(v));
  std::sort(sizes.begin(), sizes.end());
  return sizes[static_cast<std::size_t>(share * static_cast<double>(sizes.size() - 1) + 0.5)];
}

std::string Table::markdown() const {
  std::string out = accuracy_text(accuracy) + robustness(robust);
  if (!boards.empty()) out += "\n| the 13 photographed pairs, 640 x 480 | px rms |\n|---|---|\n";
  for (const BoardRow& r : boards) out += "| " + r.quantity + text(" | %.2f |\n", r.value_px);
  return out;
}

std::string Table::json() const {
  nlohmann::ordered_json all;
  for (const AccuracyRow& r : accuracy) {
    all["accuracy"].push_back({{"width", r.width},
                               {"sight", name_of(r.sight)},
                               {"distance_m", r.distance_m},
                               {"pictures", r.pictures},
                               {"found", r.found},
                               {"wrong", r.wrong},
                               {"center_rms_px", r.center_px.rms()},
                               {"center_95_px", r.center_px.percentile(0.95)},
                               {"distance_rms", r.distance.rms()},
                               {"distance_95", r.distance.percentile(0.95)},
                               {"distance_mean", r.distance.bias()}});
  }
  for (const RobustRow& r : robust) {
    all["robustness"].push_back({{"width", r.width},
                                 {"group", r.group},
                                 {"name", r.name},
                                 {"balls", r.balls},
                                 {"found", r.found},
                                 {"wrong", r.wrong},
                                 {"without", r.without},
                                 {"false_finds", r.false_finds},
                                 {"center_rms_px", r.center_px.rms()},
                                 {"distance_95", r.distance.percentile(0.95)},
                                 {"textured_px", r.textured},
                                 {"known_px", r.known},
                                 {"right_px", r.good},
                                 {"floors", r.floors},
                                 {"floors_found", r.floors_found},
                                 {"normal_95_deg", r.normal_deg.percentile(0.95)},
                                 {"height_95_mm", r.height_mm.percentile(0.95)}});
  }
  for (const BoardRow& r : boards)
    all["boards"].push_back({{"quantity", r.quantity}, {"rms_px", r.value_px}});
  return all.dump(2) + "\n";
}

}  // namespace kaz::vision_table
