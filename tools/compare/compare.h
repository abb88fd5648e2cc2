// `kaz compare`: compares two recordings.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct CompareOptions {
  std::string a, b;  // paths of recordings, or of folders that contain recording.mcap
  std::string out;   // folder for report.html, plots and result.json; empty: no files are written
  bool all = false;  // also prints measures without a difference
  bool json = false;
};

// Returns false if a measure differs between the recordings by more than its noise. Fails with Fault::usage
// if a file is not a run recording, and with Fault::environment if results cannot be written.
Result<bool> compare_recordings(const CompareOptions& options);

}  // namespace kaz::tools
