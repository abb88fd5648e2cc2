// Runs again what a recording holds, and compares.
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

// What runs again: the host on what is recorded, or host and simulation from the seed. By itself: the
// host where the recording allows it.
enum class ReplayMode { by_itself, host, whole };

struct ReplayOptions {
  std::string file;
  ReplayMode mode = ReplayMode::by_itself;
  std::optional<std::uint64_t> seed;            // another one than the recording's; whole only
  std::map<std::string, std::string> settings;  // instead of the recording's
  std::string plugin;  // path to load where the recording is of a plug-in's behaviour
  bool json = false;
  bool quiet = false;                // prints no result
  std::string label = "kaz replay";  // in front of its progress
  VisionOptions vision;
  VisionWatcher* watcher = nullptr;
  // Before it begins: further listeners to the run.
  std::function<void(SessionOptions&)> on_session;
  // Of the host alone. The recording ends once the watcher has heard of so many pairs; 0: at its end.
  std::uint64_t max_pairs = 0;
  // Of the host alone, before it runs: the recording's eyes. An error is that of the replay.
  std::function<Result<void>(const vision::CameraModel&)> on_camera;
};

// The first message in which two recordings differ.
struct Difference {
  double time_s = 0;
  std::string topic;
  // The first field that differs, where the channel has a fixed layout; else the content: text as it is,
  // the rest hexadecimal. "nothing" beyond an end.
  std::string recorded, now;
};
std::optional<Difference> first_difference(const sim::McapRecording& recorded,
                                           const sim::McapRecording& now);

// With --json: that the replay was interrupted. Nothing for other errors.
void print_interrupted(const Error& error, const ReplayOptions& options, const std::string& mode);

// False: they differ. Errors: no recording of `kaz run` or `kaz demo`, a damaged one, files that
// have changed since.
Result<bool> replay(const ReplayOptions& options);

}  // namespace kaz::tools
