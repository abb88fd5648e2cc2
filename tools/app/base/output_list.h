// The list file in a folder of results: kind of run, current writer, and names of written files.
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

// The list is a text file. The first line is "kaz-results 1"; then:
//   kind KIND      the command that writes: "run", "bench"
//   process PID    the current or last writer
//   file NAME      one line per result in this folder
struct OutputList {
  std::string kind;
  long process = 0;
  std::set<std::string> names;
  bool operator==(const OutputList&) const = default;
};

// Returns whether a file name without folder is valid: no '/', no control characters, at most 255 bytes, and
// not ".", ".." or the list's own name.
bool is_output_name(std::string_view name);
// Returns whether `kind` consists of 1 to 32 lower-case letters and spaces, without a space at either end.
bool is_output_kind(std::string_view kind);

// Error messages (usage) contain `path`. Skips an incomplete last line. The run that was killed while writing
// this line had not yet begun the file. An empty text gives an empty list.
Result<OutputList> parse_output_list(const std::string& text, const std::string& path);
std::string output_list_text(const OutputList& list);

// Returns the id of the process that holds a flock() on the file. Reads /proc/locks. Returns 0 if no process
// is listed there.
long lock_holder(const struct stat& file);

}  // namespace kaz::tools
