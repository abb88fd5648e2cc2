// The list in a folder of results: files that runs have written, the kind of run, and the current writer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <string_view>

#include <sys/stat.h>

#include "shared/base/result.hpp"

namespace kaz::tools {

inline constexpr std::string_view kOutputListName = ".kaz-results";
inline constexpr std::size_t kMaxOutputListBytes = 32 << 20;
inline constexpr std::size_t kMaxOutputNames = 500'000;

// Text format. The first line is "kaz-results 1"; then:
//   kind KIND      the command that writes: "run", "bench"
//   process PID    the current or last writer
//   file NAME      one line per result in this folder
struct OutputList {
  std::string kind;
  long process = 0;
  std::set<std::string> names;
  bool operator==(const OutputList&) const = default;
};

// Checks a file name without folder: no '/', no control characters, at most 255 bytes; not ".", ".." or the
// list's own name.
bool is_output_name(std::string_view name);
// Checks for 1 to 32 lower-case letters and inner spaces.
bool is_output_kind(std::string_view kind);

// Errors (usage) contain `path`. An incomplete last line is skipped: its run was killed before it began the
// file. An empty text is an empty list.
Result<OutputList> parse_output_list(const std::string& text, const std::string& path);
std::string output_list_text(const OutputList& list);

// Returns the process that holds a flock() of the file, from /proc/locks; 0 if it is not listed.
long lock_holder(const struct stat& file);

}  // namespace kaz::tools
