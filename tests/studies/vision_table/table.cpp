// Markdown and JSON of the tables.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/vision_table/table.h"

#include <nlohmann/json.hpp>

#include "tests/studies/common/table.h"

namespace kaz::vision_table {
namespace {

using studies::MarkdownTable;
using studies::percent;
using studies::text;

const char* name_of(Visibility visibility) {
  switch (visibility) {
    case Visibility::whole:
      return "whole";
    case Visibility::cut:
      return "cut by the image border";
    case Visibility::hidden:
      return "partly hidden";
  }
  return "";
}

std::string accuracy_text(const std::vector<AccuracyRow>& rows) {
  std::string out;
  for (auto r = rows.begin(); r != rows.end();) {
    out += text("\nBall %s, %d x %d, %d pictures a row:\n\n", name_of(r->visibility), r->width,
                r->width * 3 / 4, r->pictures);
    MarkdownTable table(
        {"distance", "found", "centre rms, 95 %", "distance rms, 95 %", "distance mean"});
    for (const auto first = r;
         r != rows.end() && r->width == first->width && r->visibility == first->visibility; ++r) {
      const std::string wrong = r->wrong > 0 ? text(", %d wrong", r->wrong) : "";
      table.add({text("%.2f m", r->distance_m),
                 text("%.1f %%%s", percent(r->found, r->pictures), wrong.c_str()),
                 text("%.2f, %.2f px", r->center_px.rms(), r->center_px.percentile(0.95)),
                 text("%.1f, %.1f %%", 100 * r->distance.rms(), 100 * r->distance.percentile(0.95)),
                 text("%+.1f %%", 100 * r->distance.mean())});
    }
    out += table.text();
  }
  return out;
}

std::vector<std::string> cells_of(const RobustRow& r) {
  std::vector<std::string> cells(8);
  cells[0] = r.name;
  if (r.balls > 0) {
    cells[1] = text("%.0f %%", percent(r.found, r.balls));
    cells[2] = text("%.0f, %.0f %%", percent(r.wrong, r.balls), percent(r.false_finds, r.without));
    if (r.found > 0) {
      cells[3] = text("%.2f px", r.center_px.rms());
      cells[4] = text("%.1f %%", 100 * r.distance.percentile(0.95));
    }
  }
  if (r.floors > 0) {
    cells[5] = r.textured > 0 ? text("%.0f, %.0f %%", percent(r.good, r.textured),
                                     percent(r.known, r.textured))
                              : std::string("no texture");
    cells[6] = text("%.0f %%", percent(r.floors_found, r.floors));
    if (r.floors_found > 0)
      cells[7] =
          text("%.1f°, %.1f mm", r.normal_deg.percentile(0.95), r.height_mm.percentile(0.95));
  }
  return cells;
}

std::string robustness_text(const std::vector<RobustRow>& rows) {
  std::string out;
  for (auto r = rows.begin(); r != rows.end();) {
    out += text(
        "\nBall at 0.25 to 1 m, depth and floor, %d x %d; up to %d pictures a row with a ball, %d "
        "without, %d stereo pairs:\n\n",
        r->width, r->width * 3 / 4, r->balls, r->without, r->floors);
    MarkdownTable table({"", "ball found", "wrong, false", "centre rms", "distance 95 %",
                         "depth correct, known", "floor found", "normal, height 95 %"});
    std::string group;
    for (const int width = r->width; r != rows.end() && r->width == width; ++r) {
      if (r->group != group) table.add({"**" + r->group + "**"});
      group = r->group;
      table.add(cells_of(*r));
    }
    out += table.text();
  }
  return out;
}

}  // namespace

std::string Table::markdown() const {
  std::string out = accuracy_text(accuracy) + robustness_text(robust);
  if (!out.empty()) out = std::string("\nPictures drawn by ") + to_string(renderer) + ".\n" + out;
  if (boards.empty()) return out;
  MarkdownTable table({"13 photographed pairs, 640 x 480", "px rms"});
  for (const BoardRow& r : boards) table.add({r.quantity, text("%.2f", r.value_px)});
  return out + "\n" + table.text();
}

std::string Table::json() const {
  nlohmann::ordered_json all;
  all["renderer"] = to_string(renderer);
  for (const AccuracyRow& r : accuracy) {
    all["accuracy"].push_back({{"width", r.width},
                               {"visibility", name_of(r.visibility)},
                               {"distance_m", r.distance_m},
                               {"pictures", r.pictures},
                               {"found", r.found},
                               {"wrong", r.wrong},
                               {"center_rms_px", r.center_px.rms()},
                               {"center_95_px", r.center_px.percentile(0.95)},
                               {"distance_rms", r.distance.rms()},
                               {"distance_95", r.distance.percentile(0.95)},
                               {"distance_mean", r.distance.mean()}});
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
                                 {"correct_px", r.good},
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
