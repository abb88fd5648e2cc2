// Profile of a run (`kaz run --profile`): shares of its time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/base/profile.hpp"

namespace kaz::tools {

struct RunProfile {
  double run_s = 0;  // robot time
  // Time of the behavior alone, without start-up and pictures drawn afterwards.
  double wall_s = 0;
  double cpu_s = 0;  // all threads, during wall_s
  int cores = 1;     // cores of this machine
  std::vector<Profile::Part> parts = {};
  std::vector<Profile::Thread> threads = {};
};

// Measures from its construction on.
class RunProfiler {
 public:
  RunProfiler();
  // Returns the measurements. Call it after the last profile scope has ended. `run_s`: robot time.
  RunProfile end(double run_s) const;

 private:
  Profile profile_;
  double wall_began_s_, cpu_began_s_;
};

// Value of `profile` in result.json.
nlohmann::ordered_json profile_json(const RunProfile& profile);
// Table for users, in lines of less than 80 characters.
std::string profile_text(const RunProfile& profile);

}  // namespace kaz::tools
