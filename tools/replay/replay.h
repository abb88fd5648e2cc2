// Repeats a recorded run, and compares the new messages with the recorded ones.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "sim/runtime/formats/mcap_reader.h"
#include "tools/run/run_observer.h"
#include "tools/vision/modules.h"

namespace kaz::tools {

// `host`: only the host runs, on recorded input. `whole`: host and simulation run again from the seed.
// `by_itself`: `host` if the recording allows this mode, else `whole`.
enum class ReplayMode { by_itself, host, whole };

struct ReplayOptions {
  std::string file;
  ReplayMode mode = ReplayMode::by_itself;
  // Seed to use instead of the recorded seed; for `whole` only.
  std::optional<std::uint64_t> seed;
  std::map<std::string, std::string> settings;  // settings that replace settings of the recording
  std::string plugin;  // path of the plug-in, if the recorded behavior is a plug-in
  bool json = false;
  bool quiet = false;                // prints no result
  std::string label = "kaz replay";  // prefix of progress messages
  VisionOptions vision;
  RunObserver* observer = nullptr;  // if not null, the observer must outlive the replay
  // For mode `host`: the replay ends after this number of pairs, as soon as the observer has all pictures
  // (RunObserver::has_all_pictures). 0: the replay ends at the end of the recording.
  std::uint64_t max_pairs = 0;
  // For mode `host`: called before the run with the recording's camera. If the function returns an error, the
  // replay ends.
  std::function<Result<void>(const vision::CameraModel&)> on_camera;
};

// First message in which two recordings differ.
struct Difference {
  double time_s = 0;
  std::string topic;
  // First field that differs, if the topic has a fixed layout. Otherwise the content of the message, as text
  // or in hexadecimal. The text is "nothing" if the recording has no further message.
  std::string recorded, now;
};
std::optional<Difference> first_difference(const sim::McapRecording& recorded,
                                           const sim::McapRecording& now);

// Returns the observer of the replayed run.
RunObserver& observer_of(const ReplayOptions& options);

// With --json, prints a result which states that the replay was interrupted. Does nothing for errors other
// than Fault::interrupted.
void print_interrupted(const Error& error, const ReplayOptions& options, const std::string& mode);

// Returns false if the recordings differ. Fails (usage) if the file is damaged, or if the file is no
// recording of `kaz run` or `kaz demo`. Lists the files of the run that have changed since the recording. A
// changed file is no error.
Result<bool> replay(const ReplayOptions& options);

}  // namespace kaz::tools
