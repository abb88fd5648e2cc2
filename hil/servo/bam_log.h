// Converts a servo log of BAM (Rhoban/bam), which is JSON, to the lines of a CSV log.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::hil {

struct BamLines {
  // Settings and column names, then one line for each entry. A missing value is the word "missing", which
  // the reader of CSV logs rejects.
  std::vector<std::string> head, entries;
};

// Errors (usage): the text is no JSON, or has no list of entries; the gain of the motor is unknown. The error
// message does not name the file.
Result<BamLines> bam_lines(const std::string& text);

}  // namespace kaz::hil
