// Parts of an evaluation that a merge joins, and the episodes that they lack.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shared/base/result.hpp"
#include "tools/app/evaluate/summary.h"

namespace kaz::tools {

struct Part {
  std::string folder;
  std::set<std::uint64_t> episodes;  // episodes in the folder
  bool has_result = false;           // else its evaluation was killed, or still runs
  std::optional<Planned> planned;    // empty in a result.json of an earlier version
  bool interrupted = false;
  std::string signal;  // signal that interrupted it
  LostEpisodes lost;
};

// `result`: from parse_result(); null if the folder has no result.json.
Part part_of(const std::string& folder, const Episodes& episodes,
             const nlohmann::ordered_json& result);

// Fails (usage) if the parts have different --episodes: none of these would be the total.
Result<void> check_one_plan(const std::vector<Part>& parts);

// Planned episodes that no part contains.
struct Shortage {
  Extent extent;
  LostEpisodes lost;     // lost to the machine in the part that should contain them
  std::string sentence;  // which episodes are missing, why, and what to do; empty if complete
};
Shortage find_shortage(const std::vector<Part>& parts);

// Returns the first 12 numbers, as "3, 7, 11".
std::string numbers_text(const std::vector<std::uint64_t>& numbers);

}  // namespace kaz::tools
