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
#include "tools/base/output_file.h"
#include "tools/eval/scenario.h"
#include "tools/run/run.h"

namespace kaz::tools {

struct CampaignOptions {
  std::string behavior;
  // For a plug-in: the built-in behavior whose success criterion applies to the plug-in; empty: no such
  // behavior.
  std::string judged_as;
  std::map<std::string, std::string> settings;  // options of the behavior
  BackendOptions backend;  // options of the robot: mcu, eyes, sensors, imu and others
  Variation variation;
  std::uint64_t seed = 1;
  std::uint64_t episodes = 20;
  std::uint64_t shard = 1, shards = 1;  // part to run: number `shard` of `shards`
  bool calibrated = false;              // calibrates the robot's joints before each episode
  // Runs robot and behavior in two processes, connected by a pty, instead of in lockstep.
  bool realtime = false;
  int jobs = 1;
  std::string out;
  bool json = false;
  // Called in each episode's process with the episode's options. Viewers can watch the episode while the
  // returned observer exists. Only its function pair() is called. Null: nobody can watch the episodes.
  std::function<std::unique_ptr<RunObserver>(BackendOptions&)> watch;

  // Returns the behavior whose evaluation applies: judged_as, or else the behavior itself. Fails (usage) if
  // there is no such behavior.
  Result<behavior::Behavior> judged_behavior() const;
};

// Returns everything that determines the course of the episodes. Campaigns with equal JSON can differ only in
// the numbers of the episodes that were run.
nlohmann::ordered_json campaign_json(const CampaignOptions& options);

// Runs those episodes of this part that are not in the results folder yet. Then writes the summary and prints
// a table. Returns false if no episode succeeded. Errors:
// - The folder belongs to another campaign, or contains episodes with larger numbers than requested.
// - The behavior is unknown.
// - The run was interrupted. Completed episodes are kept.
// - Episodes were lost because of a machine error (environment). The other episodes are kept and summarized.
//   The same command runs the lost episodes again.
Result<bool> run_campaign(const CampaignOptions& options);

// Merges the folders of one campaign's parts into the folder `out`. Errors:
// - The parts belong to different campaigns, have no episodes, or contain different results for the same
//   episode.
// - Episodes are missing in all parts (environment). The other episodes are merged and summarized, and the
//   summary is marked as interrupted.
Result<bool> merge_campaigns(const std::vector<std::string>& folders, const std::string& out,
                             bool json);
// Like merge_campaigns() above, but merges into a folder that open_campaign() has opened. That folder must
// not be one of `folders`.
Result<bool> merge_campaigns(const std::vector<std::string>& folders, const OutputFolder& out,
                             bool json);

// Opens and locks the results folder of an evaluation. Fails like OutputFolder::open().
Result<OutputFolder> open_campaign(const std::string& out);

}  // namespace kaz::tools
