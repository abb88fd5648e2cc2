// Runs one episode of a campaign.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/eval/campaign.h"
#include "tools/eval/judge.h"

namespace kaz::tools {

// Scenario of an episode, and the options of its behavior. For Stage::course, the scenario includes a world
// to walk in and a goal.
struct DrawnEpisode {
  Scenario scenario;
  std::map<std::string, std::string> settings;
};
// Draws the episode with this number. Fails (usage) if no world can be drawn that has a path to the goal, or
// enough room for its props.
Result<DrawnEpisode> draw_episode(const CampaignOptions& options, std::uint64_t number);

// Returns the value for BackendOptions::memory of the robot's board: a calibration of the joints if
// options.calibrated, else empty. Fails if a joint cannot be calibrated.
Result<std::string> episode_memory(const CampaignOptions& options, const Scenario& scenario,
                                   const std::string& robot_file);

// Adds two members to `episode`: `pushes`, the number of pushes so far, and `walked_s`, the time in s since
// the robot's first step.
void add_pushes(nlohmann::ordered_json& episode, const Scenario& scenario, const Judge& judge);

// Runs an episode in this process and returns its JSON for the campaign. If the robot failed, the recording
// of the episode is in the folder `failures`/NUMBER. If the robot succeeded, that folder is removed. Fails if
// the episode could not begin (usage), or if a problem of the machine ended the episode, such as a full disk
// (environment).
Result<nlohmann::ordered_json> run_episode(const CampaignOptions& options, std::uint64_t number,
                                           const std::string& failures);

// Runs an episode in real time, with robot and behavior in separate processes connected by a pty. Results are
// not reproducible bit by bit. The judge reads the ground truth from the simulator's control socket ten times
// per second. Fails like run_episode(). Also fails (environment) if a process was killed, if the simulator
// ended, or if the simulator lagged so much that the episode's time ran out.
Result<nlohmann::ordered_json> run_realtime_episode(const CampaignOptions& options,
                                                    std::uint64_t number,
                                                    const std::string& failures);

}  // namespace kaz::tools
