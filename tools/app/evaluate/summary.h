// Rates, intervals and causes out of the episodes of a campaign.
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
using LostEpisodes = std::map<std::uint64_t, std::string>;  // why the machine did not decide them

// Episodes 0 to `episodes` - 1, of which part `shard` of `shards` has each `shards`-th.
struct Planned {
  std::uint64_t episodes = 0;  // of all parts; 0: not stated
  std::uint64_t shard = 1, shards = 1;
};
// What of it a summary is of.
struct Extent {
  Planned planned;
  std::vector<std::uint64_t> missing = {};  // of a merge: in no part, and not lost to the machine
  bool interrupted = false;                 // before all had ended, here or in a part of a merge
  std::string signal = {};                  // that interrupted it, if one did
};

// result.json, report.html, junit.xml and episodes.csv into the folder, and a table on standard
// output (or result.json).
// Rates are those of `episodes`, which are decided; the lost ones are counted and named. False where no
// episode succeeded.
Result<bool> summarize(const nlohmann::ordered_json& campaign, const Episodes& episodes,
                       const LostEpisodes& lost, const OutputFolder& folder, bool json,
                       const Extent& extent = {});

}  // namespace kaz::tools
