// `kaz compare`: compares two recordings.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct CompareOptions {
  std::string a, b;  // recordings, or folders with recording.mcap
  std::string out;   // folder for report.html, plots and result.json; none if empty
  bool all = false;  // also prints measures without a difference
  bool json = false;
};

// Returns false if a measure differs by more than its noise. Fails with Fault::usage if a file is not a run
// recording, and with Fault::environment if results cannot be written.
Result<bool> compare_recordings(const CompareOptions& options);

}  // namespace kaz::tools
