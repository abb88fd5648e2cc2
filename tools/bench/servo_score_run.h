// `kaz bench servo-score`: fits a servo to a part of its logs, and scores the model on the other part.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct ServoScoreArguments {
  std::vector<std::string> logs;  // paths of logs or of folders of logs
  // Splits, each "gain=V,V" or "mass=V,V": logs with these values (within 1 %) are held out. "gain" or "mass"
  // alone means cross-validation: each value is held out once.
  std::vector<std::string> splits;
  int model = 0;  // number of the largest model to fit; 0: all six models
  // Model of the servo as in bus.json; not empty: replay the held-out logs on a virtual bus.
  std::string replay;
  std::string out = "kaz-servo-score";
  bool json = false;
};

// Fits and scores each split. Writes scores.csv, tables.md and result.json, for replays also replay.csv.
// Errors (usage): a split is invalid, holds out no log, or leaves none to fit; replay_log() fails.
Result<bool> run_servo_score(const ServoScoreArguments& arguments);

}  // namespace kaz::tools
