// Table of kinds of floor and thing, with the share of things that are in the map in time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/studies/map_table/approach.h"

namespace kaz::map_table {

struct Row {
  std::string floor, thing;
  Found found;
};

// Runs `approaches` approaches for each floor and thing whose name, "FLOOR THING", contains `only`. Seeds
// count from `first_seed`.
Result<std::vector<Row>> measure(const std::string& only, int approaches, std::uint64_t first_seed,
                                 sim::RendererKind renderer);
std::string markdown(const std::vector<Row>& rows);
std::string json(const std::vector<Row>& rows);

}  // namespace kaz::map_table
