// Success rates by kind of world, density and floor, with the causes of failures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/app/evaluate/summary.h"

namespace kaz::tools {

// Covers episodes in drawn worlds, which have a `world` in their scenario. Returns an empty object without
// such episodes. Members:
// - `world`, `density` (sparse, medium, dense) and `floor` contain an object for each name that occurs.
// - Each object has `episodes`, `successes`, `success_rate`, `interval` (Wilson, 95 %) and `failures`
//   (episodes by cause).
// - For successes it also has the `median` and `max` of two quantities. `off_goal_m` is the true distance
//   from the goal. `over_least` is the walking time divided by the shortest possible.
// - `moving`, if an obstacle slides into the way: `in_the_way` (episodes in which it did), and of these
//   `noticed` and `touched`.
// - `map` (map_truth.h): the shares `outline_found`, `outline_found_in_view` and `floor_wrong` over all maps.
nlohmann::ordered_json breakdown_json(const Episodes& episodes);
// Returns this as tables for a terminal; empty without episodes.
std::string breakdown_text(const nlohmann::ordered_json& breakdown);

// Returns `claims` of result.json as a sentence.
std::string claims_text(const nlohmann::ordered_json& claims);

// Returns result.json as an HTML page: rate, causes, the breakdown, and a line for each failure. Each line
// links to the files in failures/NUMBER beside the page.
std::string evaluation_page(const nlohmann::ordered_json& result, const Episodes& episodes);

}  // namespace kaz::tools
