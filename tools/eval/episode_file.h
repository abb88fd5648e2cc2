// Reads the files of a campaign, and checks everything that the summary relies on.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Parses campaign.json. Error messages (usage) of all functions in this file contain `name`.
Result<nlohmann::ordered_json> parse_campaign(const std::string& text, const std::string& name);
// Parses one episode: its number, scenario, outcome, times, results and ground truth.
Result<nlohmann::ordered_json> parse_episode(const std::string& text, const std::string& name);
// Parses the members of result.json that a merge needs: planned, lost and interrupted episodes.
Result<nlohmann::ordered_json> parse_result(const std::string& text, const std::string& name);

}  // namespace kaz::tools
