// Runs the approaches; Markdown and JSON.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/map_table/table.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "tests/studies/common/table.h"

namespace kaz::map_table {
namespace {

std::string share(int part, int all) {
  return all > 0 ? studies::text("%.1f", studies::percent(part, all)) : "none";
}

}  // namespace

Result<std::vector<Row>> measure(const std::string& only, int approaches, std::uint64_t first_seed,
                                 sim::RendererKind renderer) {
  std::vector<Row> rows;
  for (const char* floor : kFloors) {
    for (const ThingInfo& thing : kThings) {
      Row row{floor, thing.name, {}};
      if ((row.floor + " " + row.thing).find(only) == std::string::npos) continue;
      for (int i = 0; i < approaches; ++i) {
        const auto seed = first_seed + static_cast<std::uint64_t>(i);
        row.found.add(KAZ_TRY(approach(floor, thing.thing, seed, renderer)));
      }
      std::fprintf(stderr, "map_table: %s, %s: %d of %d\n", floor, thing.name, row.found.in_time,
                   row.found.things);
      rows.push_back(row);
    }
  }
  return rows;
}

std::string markdown(const std::vector<Row>& rows) {
  studies::MarkdownTable table({"floor", "thing", "in the map in time", "of the outline in view, %",
                                "floor called obstacle, %"});
  Found all;
  for (const Row& row : rows) all.add(row.found);
  const auto add = [&](const std::string& floor, const std::string& thing, const Found& f) {
    table.add({floor, thing, studies::text("%d of %d", f.in_time, f.things),
               share(f.outline_found, f.outline_points), share(f.floor_wrong, f.floor_cells)});
  };
  for (const Row& row : rows) add(row.floor, row.thing, row.found);
  add("all", "", all);
  return table.text();
}

std::string json(const std::vector<Row>& rows) {
  auto all = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    const Found& f = row.found;
    all.push_back({{"floor", row.floor},
                   {"thing", row.thing},
                   {"things", f.things},
                   {"in_time", f.in_time},
                   {"outline_points", f.outline_points},
                   {"outline_found", f.outline_found},
                   {"floor_cells", f.floor_cells},
                   {"floor_wrong", f.floor_wrong}});
  }
  return all.dump(2) + "\n";
}

}  // namespace kaz::map_table
