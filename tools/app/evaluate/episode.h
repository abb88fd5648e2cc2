// Runs one episode of a campaign.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/app/evaluate/campaign.h"
#include "tools/app/evaluate/judge.h"

namespace kaz::tools {

// Scenario, and options of the behavior. For navigate it includes a world to walk in and its goal.
struct DrawnEpisode {
  Scenario scenario;
  std::map<std::string, std::string> settings;
};
// Fails (usage) if no world with a path, or with room for its props, can be drawn.
Result<DrawnEpisode> draw_episode(const CampaignOptions& options, std::uint64_t number);

// Returns BackendOptions::memory of the robot's board: a calibration of the joints if options.calibrated,
// else empty. Fails if a joint cannot be calibrated.
Result<std::string> episode_memory(const CampaignOptions& options, const Scenario& scenario,
                                   const std::string& robot_file);

// Adds `pushes`, the number of pushes so far, and `walked_s`, the time since the first step in s.
void add_pushes(nlohmann::ordered_json& episode, const Scenario& scenario, const Judge& judge);

// Receives the JSON of an episode whose plug-in ends the process.
using KeepEpisode = std::function<void(const nlohmann::ordered_json&)>;
// Runs an episode in this process and returns its JSON for the campaign. After a failure, `failures`/NUMBER
// contains its recording; after a success it contains nothing. Fails if the episode could not begin (usage),
// or if the machine ended it: files, disk, display (environment). If a plug-in ends the process, `keep`
// receives the JSON before.
Result<nlohmann::ordered_json> run_episode(const CampaignOptions& options, std::uint64_t number,
                                           const std::string& failures, const KeepEpisode& keep);

// Runs an episode in real time, with robot and behavior in separate processes connected by a pty. Results are
// not reproducible bit by bit. The judge reads the ground truth from the simulator's control socket ten times
// per second. Does not call `keep`. Also fails (environment) if a process was killed, if the simulator ended,
// or if it lagged so far that the time ran out.
Result<nlohmann::ordered_json> run_realtime_episode(const CampaignOptions& options,
                                                    std::uint64_t number,
                                                    const std::string& failures,
                                                    const KeepEpisode& keep);

}  // namespace kaz::tools
