// `kaz vision run`: the modules of vision on pictures in a folder.
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
  std::vector<std::string> left, right;  // stereo pairs, in place of `in`
  std::string in, out, modules = "color";
  std::string exported;            // of depth,points; empty: none
  std::string robot;               // serial:PATH[@BAUD]; of a live camera
  std::uint8_t address = 1;        // of the robot's board
  std::uint64_t frames = 0;        // 0: all, or until interrupted
  std::string color, calibration;  // files; empty: the red ball, no calibration
  double view_deg = 0;             // horizontally, of a pinhole, where there is no calibration
  double radius_m = 0.020;
  std::optional<double> nearest_m;  // of depth; nothing: its default
  bool json = false;
};

// For each picture NAME: NAME.ball.png, a line of ball.csv and an entry of result.json. A picture
// that cannot be read is an entry with its error. False if none could be processed.
Result<bool> run_on_pictures(const RecordedOptions& options);
// Of stereo pairs: for each LEFT.vision.png, a line of frames.csv and an entry of result.json.
Result<bool> run_on_pairs(const RecordedOptions& options);

// The same of a live camera, until so many pairs have been looked at or it is interrupted; with a
// robot at a port frames carry its posture, and the floor is known.
Result<bool> run_on_camera(const RecordedOptions& options);
// The same of a recording (kaz run --record-pictures), with the posture that the board reported then.
Result<bool> run_on_recording(const RecordedOptions& options);
// `options.in`: a folder, a recording, a picture, a camera socket or v4l2 cameras; chooses from the above.
Result<bool> run_on_source(const RecordedOptions& options);

// What all of them write into their folder.
const OutputKind& vision_output();

// The ball to look for: its radius, and its colour from the file if one is named.
Result<vision::BallOptions> ball_options(const RecordedOptions& options);
}  // namespace kaz::tools
