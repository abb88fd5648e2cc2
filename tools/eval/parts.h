// Finds the episodes that are missing when the parts of an evaluation are merged.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shared/base/result.hpp"
#include "tools/eval/summary.h"

namespace kaz::tools {

struct Part {
  std::string folder;
  std::set<std::uint64_t> episodes;  // episodes in the folder
  // False: the evaluation of this part was killed, or is still running.
  bool has_result = false;
  std::optional<Planned> planned;  // empty if an earlier version has written result.json
  bool interrupted = false;
  std::string signal;  // name of the signal that interrupted the part
  LostEpisodes lost;
};

// `result`: value that parse_result() returned; null if the folder has no result.json.
Part part_of(const std::string& folder, const Episodes& episodes,
             const nlohmann::ordered_json& result);

// Fails (usage) if the parts were run with different values of --episodes, because the total number of
// episodes is then unknown.
Result<void> check_one_plan(const std::vector<Part>& parts);

// Planned episodes that no part contains.
struct Shortage {
  Extent extent;
  LostEpisodes lost;     // missing episodes that were lost because of a machine error
  std::string sentence;  // which episodes are missing, why, and what to do; empty if complete
};
Shortage find_shortage(const std::vector<Part>& parts);

// Returns the first 12 numbers as text, for example "3, 7, 11".
std::string numbers_text(const std::vector<std::uint64_t>& numbers);

}  // namespace kaz::tools
