// Success by kind of world, density and floor, with the causes of failure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/app/evaluate/summary.h"

namespace kaz::tools {

// Of episodes that walk in drawn worlds (their scenario has a `world`); an empty object without any.
// `world`, `density` (sparse, medium, dense) and `floor`: of each name that occurs `episodes`, `successes`,
// `success_rate`, `interval` (Wilson, 95 %), `failures` (episodes by cause); of the successes `off_goal_m` by
// truth and `over_least`, the walking time over the least possible: `median`, `max`. `moving`, where a thing
// slides into the way: `in_the_way` (episodes in which it did), and of these `noticed` and `touched`. `map`
// (map_truth.h): shares `outline_found` and `floor_wrong` over all maps.
nlohmann::ordered_json breakdown_json(const Episodes& episodes);
// Tables of it, for a terminal; empty without.
std::string breakdown_text(const nlohmann::ordered_json& breakdown);

// `claims` of result.json as a sentence.
std::string claims_text(const nlohmann::ordered_json& claims);

// `result.json` as a page: rate, causes, the breakdown, and a line for each failure with links to what is
// kept of it in failures/NUMBER beside the page.
std::string evaluation_page(const nlohmann::ordered_json& result, const Episodes& episodes);

}  // namespace kaz::tools
