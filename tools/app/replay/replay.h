// Runs a recorded run again, and compares.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "sim/runtime/formats/mcap_reader.h"
#include "tools/app/vision/modules.h"

namespace kaz::tools {

struct SessionOptions;

// host: the host alone on recorded input. whole: host and simulation from the seed. by_itself: host if the
// recording allows it, else whole.
enum class ReplayMode { by_itself, host, whole };

struct ReplayOptions {
  std::string file;
  ReplayMode mode = ReplayMode::by_itself;
  std::optional<std::uint64_t> seed;            // another seed; for `whole` only
  std::map<std::string, std::string> settings;  // override the recording's settings
  std::string plugin;  // path of the plug-in, if the recording's behavior was one
  bool json = false;
  bool quiet = false;                // prints no result
  std::string label = "kaz replay";  // prefix of progress messages
  VisionOptions vision;
  VisionWatcher* watcher = nullptr;
  // Called before the run, to add further observers.
  std::function<void(SessionOptions&)> on_session;
  // Host alone: the replay ends once the watcher has received this number of pairs; 0: at the recording's
  // end.
  std::uint64_t max_pairs = 0;
  // Host alone: called before the run with the recording's camera. An error ends the replay.
  std::function<Result<void>(const vision::CameraModel&)> on_camera;
};

// First message in which two recordings differ.
struct Difference {
  double time_s = 0;
  std::string topic;
  // First different field, if the topic has a fixed layout. Otherwise the content, as text or in hexadecimal.
  // "nothing" beyond the end of a recording.
  std::string recorded, now;
};
std::optional<Difference> first_difference(const sim::McapRecording& recorded,
                                           const sim::McapRecording& now);

// With --json, prints that the replay was interrupted. Ignores other errors.
void print_interrupted(const Error& error, const ReplayOptions& options, const std::string& mode);

// Returns false if the recordings differ. Fails (usage) if the file is damaged, or is no recording of `kaz
// run` or `kaz demo`. Files that have changed since are listed, and are no error.
Result<bool> replay(const ReplayOptions& options);

}  // namespace kaz::tools
