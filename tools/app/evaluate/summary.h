// Rates, intervals and causes out of the episodes of a campaign.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/app/base/output.h"

namespace kaz::tools {

using Episodes = std::map<std::uint64_t, nlohmann::ordered_json>;  // by number
using LostEpisodes = std::map<std::uint64_t, std::string>;  // why the machine did not decide them

// result.json and episodes.csv into the folder, and a table on standard output (or result.json).
// Rates are those of `episodes`, which are decided; the lost ones are counted and named. False where no
// episode succeeded. `interrupted`: by a signal, before all had ended.
Result<bool> summarize(const nlohmann::ordered_json& campaign, const Episodes& episodes,
                       const LostEpisodes& lost, const OutputFolder& folder, bool json,
                       bool interrupted = false);

}  // namespace kaz::tools
