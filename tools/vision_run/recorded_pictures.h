// `kaz vision run`: runs the vision modules on pictures, pairs, recordings and live cameras.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "tools/base/output.h"
#include "vision/color/ball.h"
#include "vision/depth/depth.h"

namespace kaz::tools {

struct RecordedOptions {
  // Left and right pictures of stereo pairs; used instead of `in`.
  std::vector<std::string> left, right;
  std::string in, out, modules = "color";
  // Files to export: "depth", "points" or both, separated by a comma; empty: no files.
  std::string exported;
  // Topics of a recording of another program, LEFT,RIGHT; empty: the only pair of topics.
  std::string topics;
  std::string robot;         // port of the robot, serial:PATH[@BAUD]; only with a live camera
  std::uint8_t address = 1;  // address of the robot's board
  // Maximum number of frames; 0: all frames, or frames until an interrupt.
  std::uint64_t frames = 0;
  std::string color, calibration;  // paths of files; empty: color of the red ball, no calibration
  double view_deg = 0;  // horizontal field of view of a pinhole camera, used without a calibration
  double radius_m = 0.020;
  // Smallest distance that the module `depth` measures; empty: the default.
  std::optional<double> nearest_m;
  bool json = false;
};

// Processes single pictures. For each picture NAME writes NAME.ball.png, a line of ball.csv and an entry of
// result.json. If a picture cannot be read, its entry contains the error. Returns false if no picture could
// be processed.
Result<bool> run_on_pictures(const RecordedOptions& options);
// Processes stereo pairs. For each pair writes LEFT.vision.png (LEFT: name of the left picture), a line of
// frames.csv and an entry of result.json.
Result<bool> run_on_pairs(const RecordedOptions& options);

// Processes the pairs of a live camera like run_on_pairs(). Ends after `frames` pairs or at an interrupt. If
// `robot` is given, frames contain the robot's posture, so that the floor can be found.
Result<bool> run_on_camera(const RecordedOptions& options);
// Processes the pairs of a recording (`kaz run --record-pictures`) like run_on_pairs(), with the postures
// that the board reported.
Result<bool> run_on_recording(const RecordedOptions& options);
// Calls the function above that fits `options.in`: a folder, a recording, a picture, a camera socket or v4l2
// cameras.
Result<bool> run_on_source(const RecordedOptions& options);

// Returns the names of the files that the functions above write into their folder.
const OutputKind& vision_output();

// Returns radius and color of the ball to detect. If `color` is not empty, the color comes from the file
// `color`.
Result<vision::BallOptions> ball_options(const RecordedOptions& options);
}  // namespace kaz::tools
