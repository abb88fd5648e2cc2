// What `kaz run --profile` measures: where the time of a run goes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/base/profile.hpp"

namespace kaz::tools {

struct RunProfile {
  double run_s = 0;  // time of the robot
  double wall_s =
      0;             // of the behaviour's run alone, without start-up and pictures drawn afterwards
  double cpu_s = 0;  // of all threads meanwhile
  int cores = 1;     // of the machine
  std::vector<Profile::Part> parts = {};
  std::vector<Profile::Thread> threads = {};
};

// Measures from its construction until end(), or its destruction.
class RunProfiler {
 public:
  RunProfiler();
  // To be called after the last scope has ended. `run_s`: time of the robot.
  RunProfile end(double run_s) const;

 private:
  Profile profile_;
  double wall_began_s_, cpu_began_s_;
};

// result.json's "profile".
nlohmann::ordered_json profile_json(const RunProfile& profile);
// A table for people, lines of less than 80 characters.
std::string profile_text(const RunProfile& profile);

}  // namespace kaz::tools
