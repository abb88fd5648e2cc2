// `kaz vision run`: runs the vision modules on pictures, pairs, recordings and live cameras.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "tools/app/base/output.h"
#include "vision/color/ball.h"
#include "vision/depth/depth.h"

namespace kaz::tools {

struct RecordedOptions {
  std::vector<std::string> left, right;  // stereo pairs, instead of `in`
  std::string in, out, modules = "color";
  std::string exported;            // depth, points or both, separated by a comma; empty: none
  std::string robot;               // serial:PATH[@BAUD], with a live camera
  std::uint8_t address = 1;        // address of the robot's board
  std::uint64_t frames = 0;        // maximum number of frames; 0: all, or until interrupted
  std::string color, calibration;  // files; empty: the red ball, no calibration
  double view_deg = 0;  // horizontal field of view of a pinhole camera, used without a calibration
  double radius_m = 0.020;
  std::optional<double> nearest_m;  // least distance of depth; empty: the default
  bool json = false;
};

// Processes single pictures. Writes NAME.ball.png, a line of ball.csv and an entry of result.json for each
// picture NAME. An unreadable picture gets an entry with its error. Returns false if no picture could be
// processed.
Result<bool> run_on_pictures(const RecordedOptions& options);
// Processes stereo pairs. Writes LEFT.vision.png, a line of frames.csv and an entry of result.json for each.
Result<bool> run_on_pairs(const RecordedOptions& options);

// Processes pairs of a live camera as run_on_pairs(), until `frames` pairs are processed or an interrupt.
// With a robot at a port, frames contain its posture, and the floor can be found.
Result<bool> run_on_camera(const RecordedOptions& options);
// Processes a recording (kaz run --record-pictures) as run_on_pairs(), with the posture that the board
// reported.
Result<bool> run_on_recording(const RecordedOptions& options);
// Calls one of these for `options.in`: a folder, a recording, a picture, a camera socket or v4l2 cameras.
Result<bool> run_on_source(const RecordedOptions& options);

// Files that these functions write into their folder.
const OutputKind& vision_output();

// Returns the ball to detect: its radius, and the color from the file, if any.
Result<vision::BallOptions> ball_options(const RecordedOptions& options);
}  // namespace kaz::tools
