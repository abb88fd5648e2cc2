// result.json and the pictures of a run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "host/behavior/behavior.h"
#include "host/link/link_statistics.h"
#include "tools/app/base/output.h"
#include "tools/app/session/backend.h"
#include "tools/app/session/run_lateness.h"
#include "tools/app/session/run_profile.h"
#include "tools/app/session/score.h"
#include "tools/app/session/snapshots.h"
#include "tools/figure/figure.h"

namespace kaz::tools {

struct RunReport {
  std::string behavior = {};
  BackendOptions backend = {};
  behavior::Outcome outcome = {};
  double run_s = 0;  // time of the robot
  double rtf = 0;    // run_s over wall time
  Score score = {};
  kz_identify_reply identity{};
  kz_statistics_reply health{};
  host::LinkStatistics link = {};
  Time start{};
  const behavior::Recording& recording;
  const TruthProbe* probe = nullptr;
  nlohmann::ordered_json vision = {};  // by module: frames, times
  std::string vision_text = {};        // the same for people
  std::string vision_table = {};       // CSV, a line for each result
  bool interrupted = false;            // it is of the part before a signal
  std::optional<RunProfile> profile = {};
  std::string recording_sha256 = {};         // empty: there is none
  std::string camera_warning = {};           // SessionBackend::camera_warning()
  std::optional<RunLateness> lateness = {};  // of a run at a port
  // The robot has not succeeded, and the machine was too late to blame it; outcome.sentence says so.
  bool machine_failed = false;
  const std::optional<figure::Image>* map = nullptr;  // the behaviour's, if it has one
  std::vector<faults::Fault> not_begun = {};          // SessionBackend::faults_not_begun()
  std::optional<sim::ScenePose> start_pose = {};      // of the simulated world
  bool looks = true;  // the behavior uses the eyes; if not, missing plots of the ball are no news
};

// What a run writes into its folder, and the file as which its recording grows there.
const OutputKind& run_output();
std::string growing_recording(const OutputFolder& folder);
// The recording, which has ended, as recording.mcap. Returns its path.
Result<std::string> place_recording(const OutputFolder& folder);

// result.json of a run that broke off: why it ended, and what it was of. No more is known of it for certain.
nlohmann::ordered_json broken_off_json(const char* outcome, const std::string& sentence,
                                       const std::string& behavior, const BackendOptions& backend);
// `duration_s` and `rtf`, rounded.
void add_times(nlohmann::ordered_json& result, double run_s, double rtf);

// Where there is a folder, fills it, result.json last. `recorded`: a recording grew there, and has ended.
// Returns the content of result.json.
Result<nlohmann::ordered_json> write_report(const RunReport& report, sim::Simulation* simulation,
                                            const Snapshots& snapshots, const OutputFolder* folder,
                                            bool recorded);

// A few lines for people, or the whole result as JSON, on standard output.
void print_report(const nlohmann::ordered_json& result, const RunReport& report,
                  const std::string& out, bool json);

}  // namespace kaz::tools
