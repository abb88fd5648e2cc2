// The parts of an evaluation that a merge joins, and what they lack of the whole.
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
  std::set<std::uint64_t> episodes;  // that it holds
  bool has_result = false;           // else its evaluation was killed, or still runs
  std::optional<Planned> planned;    // a result.json of an earlier version does not state it
  bool interrupted = false;
  std::string signal;  // that interrupted it
  LostEpisodes lost;
};

// `result`: of parse_result(); null if the folder has none.
Part part_of(const std::string& folder, const Episodes& episodes,
             const nlohmann::ordered_json& result);

// Errors (usage): parts of different --episodes, none of which would be the plan of the whole.
Result<void> check_one_plan(const std::vector<Part>& parts);

// What of the planned episodes no part holds.
struct Shortage {
  Extent extent;
  LostEpisodes lost;     // to the machine, in the part that should have them
  std::string sentence;  // which episodes are missing, why, and what to do; empty: none
};
Shortage find_shortage(const std::vector<Part>& parts);

// "3, 7, 11": the first 12.
std::string numbers_text(const std::vector<std::uint64_t>& numbers);

}  // namespace kaz::tools
