// One episode of a campaign.
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

// Scenario and options of the behaviour; of `navigate` with a world to walk in and its goal.
struct DrawnEpisode {
  Scenario scenario;
  std::map<std::string, std::string> settings;
};
// Errors (usage): there is no such world.
Result<DrawnEpisode> draw_episode(const CampaignOptions& options, std::uint64_t number);

// BackendOptions::memory of its robot's board: with a calibration of the joints where that is asked for, else
// empty. Errors: a joint that could not be calibrated.
Result<std::string> episode_memory(const CampaignOptions& options, const Scenario& scenario,
                                   const std::string& robot_file);

// Adds `pushes`, the number of pushes that happened, and `walked_s`, the time since the first step in s.
void add_pushes(nlohmann::ordered_json& episode, const Scenario& scenario, const Judge& judge);

// Runs it in this process. A failure leaves its recording in `failures`/NUMBER; a success leaves
// nothing there. The answer is what the campaign keeps of it. Errors: it could not be begun (usage), or
// the machine ended it: files, disk, display (environment).
// Where a plug-in ends the process instead, `keep` is called with the answer before.
using KeepEpisode = std::function<void(const nlohmann::ordered_json&)>;
Result<nlohmann::ordered_json> run_episode(const CampaignOptions& options, std::uint64_t number,
                                           const std::string& failures, const KeepEpisode& keep);

// The same in real time, robot and behaviour in processes of their own, a pty between them: nothing
// repeats to the bit. Judged by the same truth, which the simulator's control socket has ten times a second.
// Errors (environment) too: a process was killed, the simulator ended, or lagged so far that time ran out.
Result<nlohmann::ordered_json> run_realtime_episode(const CampaignOptions& options,
                                                    std::uint64_t number,
                                                    const std::string& failures,
                                                    const KeepEpisode& keep);

}  // namespace kaz::tools
