// Computes rates, intervals and causes from the episodes of a campaign.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/app/base/output.h"

namespace kaz::tools {

using Episodes = std::map<std::uint64_t, nlohmann::ordered_json>;  // by number
using LostEpisodes = std::map<std::uint64_t, std::string>;  // lost to the machine, with the reason

// Plan of episodes 0 to `episodes` - 1. Part `shard` contains every `shards`-th of them.
struct Planned {
  std::uint64_t episodes = 0;  // over all parts; 0: unknown
  std::uint64_t shard = 1, shards = 1;
};
// Part of the plan that a summary covers.
struct Extent {
  Planned planned;
  // After a merge: in no part, and not lost to the machine.
  std::vector<std::uint64_t> missing = {};
  bool interrupted = false;  // before all ended, here or in a merged part
  std::string signal = {};   // signal that interrupted it, if any
};

// Writes result.json, report.html, junit.xml and episodes.csv into the folder. Prints a table, or result.json
// with `json`. The rates cover `episodes`, which are decided; lost episodes are counted and listed. Returns
// false if no episode succeeded.
Result<bool> summarize(const nlohmann::ordered_json& campaign, const Episodes& episodes,
                       const LostEpisodes& lost, const OutputFolder& folder, bool json,
                       const Extent& extent = {});

}  // namespace kaz::tools
