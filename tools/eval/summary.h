// Computes rates, intervals and causes from the episodes of a campaign.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/base/output.h"

namespace kaz::tools {

using Episodes = std::map<std::uint64_t, nlohmann::ordered_json>;  // key: number of the episode
// Episodes lost because of a machine error, with the reason.
using LostEpisodes = std::map<std::uint64_t, std::string>;

// Plan of an evaluation with the episodes 0 to `episodes` - 1. Part `shard` contains every `shards`-th
// episode.
struct Planned {
  std::uint64_t episodes = 0;  // number of episodes in all parts; 0: unknown
  std::uint64_t shard = 1, shards = 1;
};
// Part of the plan that a summary covers.
struct Extent {
  Planned planned;
  // After a merge: numbers of episodes that no part contains, except those lost because of a machine error.
  std::vector<std::uint64_t> missing = {};
  // A signal ended this evaluation, or a merged part, before all its episodes had ended.
  bool interrupted = false;
  std::string signal = {};  // name of that signal; empty: no signal
};

// Writes result.json, report.html, junit.xml and episodes.csv into the folder. Prints a table, or result.json
// with `json`. The rates cover only `episodes`, because success is known only for these episodes. Lost
// episodes are counted and listed. Returns false if no episode succeeded.
Result<bool> summarize(const nlohmann::ordered_json& campaign, const Episodes& episodes,
                       const LostEpisodes& lost, const OutputFolder& folder, bool json,
                       const Extent& extent = {});

}  // namespace kaz::tools
