// Writes result.json and the pictures of a run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "host/behavior/behavior.h"
#include "host/link/link_statistics.h"
#include "tools/base/output.h"
#include "tools/drawing/figure.h"
#include "tools/run/backend.h"
#include "tools/run/run_lateness.h"
#include "tools/run/run_profile.h"
#include "tools/run/score.h"
#include "tools/run/snapshots.h"

namespace kaz::tools {

struct BehaviorReport {
  std::string behavior = {};
  BackendOptions backend = {};
  behavior::Outcome outcome = {};
  double run_s = 0;  // duration of the run in robot time
  double rtf = 0;    // real-time factor: run_s divided by wall time
  Score score = {};
  kz_identify_reply identity{};
  kz_statistics_reply health{};
  host::LinkStatistics link = {};
  Time start{};
  const behavior::Recording& recording;
  const TruthProbe* probe = nullptr;
  nlohmann::ordered_json vision = {};  // for each module: number of frames, times
  std::string vision_text = {};        // `vision` as text for users
  std::string vision_table = {};       // `vision` in detail as CSV, one line per result
  bool interrupted = false;            // a signal ended the run
  std::optional<RunProfile> profile = {};
  std::string recording_sha256 = {};         // empty if there is no recording
  std::string camera_warning = {};           // SessionBackend::camera_warning()
  std::optional<RunLateness> lateness = {};  // set only for a run at a port
  // True: the robot did not succeed, but this machine was so late that the robot may not be the cause.
  // outcome.sentence contains the reason.
  bool machine_failed = false;
  // Picture of the map; empty if the behavior has no map.
  const std::optional<figure::Image>* map = nullptr;
  std::vector<faults::Fault> not_begun = {};  // SessionBackend::faults_not_begun()
  // Poses of the simulated world at the start of the run.
  std::optional<sim::ScenePose> start_pose = {};
  // True: the behavior uses the eyes. False: missing plots of the ball are not reported.
  bool looks = true;
};

// Returns the names of the files that a run writes into its folder.
const OutputKind& run_output();
// Returns the path at which the recording is written during the run. `out`: path of the results folder.
std::string growing_recording(const std::string& out);
// Renames the completed recording to recording.mcap. Returns the new path.
Result<std::string> place_recording(const OutputFolder& folder);

// Returns the content of result.json for a run that broke off. The content is only the reason and the
// options, because other values would be unreliable.
nlohmann::ordered_json broken_off_json(const char* outcome, const std::string& sentence,
                                       const std::string& behavior, const BackendOptions& backend);
// Sets the members `duration_s` and `rtf` to rounded values.
void add_times(nlohmann::ordered_json& result, double run_s, double rtf);

// Writes all files into `folder`, result.json last. Writes no files if `folder` is null. `recorded`: the
// folder contains a completed recording under its temporary name. Returns the content of result.json.
Result<nlohmann::ordered_json> write_report(const BehaviorReport& report,
                                            sim::Simulation* simulation, const Snapshots& snapshots,
                                            const OutputFolder* folder, bool recorded);

// Prints a few lines for users to standard output. With `json`, prints the complete result instead.
void print_report(const nlohmann::ordered_json& result, const BehaviorReport& report,
                  const std::string& out, bool json);

}  // namespace kaz::tools
