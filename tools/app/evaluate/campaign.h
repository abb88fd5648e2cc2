// Runs many episodes of one behavior, each in its own process, and stores each result at once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/behavior/behavior.h"
#include "shared/base/result.hpp"
#include "tools/app/base/output_folder.h"
#include "tools/app/evaluate/scenario.h"
#include "tools/app/session/session.h"

namespace kaz::tools {

struct CampaignOptions {
  std::string behavior;
  // For a plug-in: the behavior of Kaz whose criterion applies; empty: none.
  std::string judged_as;
  std::map<std::string, std::string> settings;  // options of the behavior
  BackendOptions backend;  // options of the robot: mcu, eyes, sensors, imu and others
  Variation variation;
  std::uint64_t seed = 1;
  std::uint64_t episodes = 20;
  std::uint64_t shard = 1, shards = 1;  // this is part `shard` of `shards`
  bool calibrated = false;              // calibrates each robot's joints before its episode
  bool realtime = false;                // two processes and a pty instead of lockstep
  int jobs = 1;
  std::string out;
  bool json = false;
  // Lets viewers watch an episode, in the episode's process, while the returned object lives. Null: not this
  // episode.
  std::function<std::shared_ptr<void>(SessionOptions&)> watch;

  // Behavior whose criterion decides success.
  const std::string& task() const { return judged_as.empty() ? behavior : judged_as; }
};

// Returns everything that determines the course of the episodes. Campaigns with equal JSON differ only in
// which episodes they ran.
nlohmann::ordered_json campaign_json(const CampaignOptions& options);

// Runs the episodes of this part that the folder lacks, then writes summary and table. Returns false if no
// episode succeeded. Errors:
// - The folder belongs to another campaign, or contains episodes beyond the requested ones.
// - Unknown behavior.
// - Interrupted: completed episodes are kept.
// - Episodes lost to the machine (environment): the others are kept and summarized, and the same command runs
//   the lost ones again.
Result<bool> run_campaign(const CampaignOptions& options);

// Merges folders of parts of one campaign. Errors:
// - The parts belong to different campaigns, have no episodes, or contain different results for one episode.
// - Episodes are missing in all parts (environment): the others are merged and summarized, marked as
//   interrupted.
Result<bool> merge_campaigns(const std::vector<std::string>& folders, const std::string& out,
                             bool json);
// Merges into a folder from open_campaign(), which must not be one of `folders`.
Result<bool> merge_campaigns(const std::vector<std::string>& folders, const OutputFolder& out,
                             bool json);

// Opens and locks the results folder of an evaluation. Errors as of OutputFolder::open().
Result<OutputFolder> open_campaign(const std::string& out);

}  // namespace kaz::tools
