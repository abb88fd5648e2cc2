// `kaz vision run`: the modules of vision on pictures in a folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/kaz/verbs.h"

namespace kaz::tools {

struct RecordedOptions {
  std::string in, out, modules = "color";
  std::string color, calibration;  // files; empty: the red ball, no calibration
  double view_deg = 0;             // horizontally, of a pinhole, where there is no calibration
  double radius_m = 0.020;
  bool json = false;
};

// For each picture NAME: NAME.ball.png, a line of ball.csv and an entry of result.json. What cannot be
// read is an entry with its trouble. 1 if none could be looked at.
Result<Outcome> run_on_pictures(const RecordedOptions& options);

}  // namespace kaz::tools
