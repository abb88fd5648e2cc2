// Many episodes of one behaviour: each in a process of its own, each kept as soon as it has ended.
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
  std::string judged_as;  // of a plug-in: the behaviour of Kaz whose criterion decides; empty: none
  std::map<std::string, std::string> settings;  // of the behaviour
  BackendOptions backend;                       // mcu, eyes, sensors, imu and so on
  Variation variation;
  std::uint64_t seed = 1;
  std::uint64_t episodes = 20;
  std::uint64_t shard = 1, shards = 1;  // this is part `shard` of so many
  bool calibrated = false;              // each robot's joints, before its episode
  bool realtime = false;                // two processes and a pty instead of lockstep
  int jobs = 1;
  std::string out;
  bool json = false;
  // Lets viewers see an episode, in its own process, until what it returns goes; null: not this one.
  std::function<std::shared_ptr<void>(SessionOptions&)> watch;

  // What truth decides by.
  const std::string& task() const { return judged_as.empty() ? behavior : judged_as; }
};

// What decides how each episode goes: campaigns with the same text differ only in which they ran.
nlohmann::ordered_json campaign_json(const CampaignOptions& options);

// Runs those episodes of the part that are not in the folder yet, then writes summary and table.
// False where not one episode succeeded. Errors: a folder of another campaign, or with episodes that are not
// asked for; interruption (what has ended is kept), a behaviour that there is none of, episodes lost to the
// machine (environment; the others are kept and summarized, the same command runs the lost ones again).
Result<bool> run_campaign(const CampaignOptions& options);

// Joins folders of parts of one campaign. Errors: parts of different campaigns, the same episode
// with different results, none; episodes that no part holds (environment; the others are merged and
// summarized, marked as interrupted).
Result<bool> merge_campaigns(const std::vector<std::string>& folders, const std::string& out,
                             bool json);
// The same into a folder of open_campaign(), which is not one of `folders`.
Result<bool> merge_campaigns(const std::vector<std::string>& folders, const OutputFolder& out,
                             bool json);

// The results folder of an evaluation, locked. Errors: as of OutputFolder::open().
Result<OutputFolder> open_campaign(const std::string& out);

}  // namespace kaz::tools
