// `kaz compare`: two recordings side by side.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct CompareOptions {
  std::string a, b;  // recordings, or folders with recording.mcap
  std::string out;   // folder for report.html, plots and result.json; none if empty
  bool all = false;  // prints what does not differ, too
  bool json = false;
};

// False: something differs by more than its noise. Errors: usage, of files that are no recordings of runs;
// environment, of results that cannot be written.
Result<bool> compare_recordings(const CompareOptions& options);

}  // namespace kaz::tools
