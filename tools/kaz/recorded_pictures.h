// `kaz vision run`: the modules of vision on pictures in a folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/kaz/verbs.h"
#include "vision/ball.h"
#include "vision/depth.h"

namespace kaz::tools {

struct RecordedOptions {
  std::vector<std::string> left, right;  // stereo pairs, in place of `in`
  std::string in, out, modules = "color";
  std::string color, calibration;  // files; empty: the red ball, no calibration
  double view_deg = 0;             // horizontally, of a pinhole, where there is no calibration
  double radius_m = 0.020;
  double nearest_m = vision::DepthOptions{}.nearest_m;
  bool json = false;
};

// For each picture NAME: NAME.ball.png, a line of ball.csv and an entry of result.json. What cannot be
// read is an entry with its trouble. 1 if none could be looked at.
Result<Outcome> run_on_pictures(const RecordedOptions& options);
// The same of stereo pairs, with depth and planes: LEFT.pair.png, pairs.csv, result.json.
Result<Outcome> run_on_pairs(const RecordedOptions& options);

// The ball to look for: its radius, and its colour from the file if one is named.
Result<vision::BallOptions> ball_options(const RecordedOptions& options);
// What result.json says of a ball.
nlohmann::ordered_json ball_json(const vision::BallObservation& ball);

}  // namespace kaz::tools
