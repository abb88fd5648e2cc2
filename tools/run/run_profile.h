// Profile of a run (`kaz run --profile`): time spent in each part of the program.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/base/profile.hpp"

namespace kaz::tools {

struct RunProfile {
  double run_s = 0;  // duration of the run in robot time
  // Wall time of the behavior, without start-up and without drawing pictures after the run.
  double wall_s = 0;
  double cpu_s = 0;  // CPU time of all threads during wall_s
  int cores = 1;     // cores of this machine
  std::vector<Profile::Part> parts = {};
  std::vector<Profile::Thread> threads = {};
};

// Measures a profile. The measurement begins with the construction of this object.
class RunProfiler {
 public:
  RunProfiler();
  // Returns the measurements. Call end() after the last profile scope has ended. `run_s`: duration of the run
  // in robot time.
  RunProfile end(double run_s) const;

 private:
  Profile profile_;
  double wall_began_s_, cpu_began_s_;
};

// Returns the value of the member `profile` of result.json.
nlohmann::ordered_json profile_json(const RunProfile& profile);
// Returns a table for users, with lines of less than 80 characters.
std::string profile_text(const RunProfile& profile);

}  // namespace kaz::tools
