// The files of a campaign as they are read back: what the summary takes for granted is checked here.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"

namespace kaz::tools {

// campaign.json. Errors (usage) name the file.
Result<nlohmann::ordered_json> parse_campaign(const std::string& text, const std::string& name);
// One episode: its number, scenario, outcome, times, results and ground truth.
Result<nlohmann::ordered_json> parse_episode(const std::string& text, const std::string& name);
// result.json, as far as a merge reads it: what was planned, lost, interrupted.
Result<nlohmann::ordered_json> parse_result(const std::string& text, const std::string& name);

}  // namespace kaz::tools
