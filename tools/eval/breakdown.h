// Computes success rates by kind of world, density and floor, with the causes of failures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/eval/summary.h"

namespace kaz::tools {

// Covers only episodes in randomly drawn worlds. The scenario of such an episode has the member `world`.
// Returns an empty object if there are no such episodes. Members of the object:
// - `world`, `density` (sparse, medium, dense) and `floor` contain one object per name that occurs in the
//   episodes, for example `dense`.
// - Each of these objects has `episodes`, `successes`, `success_rate`, `interval` (Wilson, 95 %) and
//   `failures` (episodes by cause).
// - Each of these objects also has `off_goal_m` and `over_least`, with `median` and `max` over the successful
//   episodes. `off_goal_m` is the true distance from the goal. `over_least` is the walking time divided by
//   the shortest possible walking time.
// - `moving` is present if the worlds have sliding obstacles. `in_the_way` is the number of episodes in which
//   an obstacle slid into the robot's way. In `noticed` of these episodes, the robot noticed the obstacle. In
//   `touched` of these episodes, the robot touched an obstacle.
// - `map` (map_truth.h) has the shares `outline_found`, `outline_found_in_view` and `floor_wrong` over all
//   maps.
nlohmann::ordered_json breakdown_json(const Episodes& episodes);
// Returns the result of breakdown_json() as tables for a terminal; empty if the breakdown covers no episodes.
std::string breakdown_text(const nlohmann::ordered_json& breakdown);

// Returns the member `claims` of result.json as a sentence.
std::string claims_text(const nlohmann::ordered_json& claims);

// Returns result.json as an HTML page: success rate, causes of failures, breakdown, and one line per failed
// episode. Each line links to the episode's files in failures/NUMBER beside the page.
std::string evaluation_page(const nlohmann::ordered_json& result, const Episodes& episodes);

}  // namespace kaz::tools
