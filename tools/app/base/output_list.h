// The list in a folder of results: which files a run of which kind has written there, and who writes now.
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

// Lines of text, the first one "kaz-results 1":
//   kind KIND      the verb that writes: "run", "bench"
//   process PID    that wrote last, or does now
//   file NAME      one for each result, in this folder itself
struct OutputList {
  std::string kind;
  long process = 0;
  std::set<std::string> names;
  bool operator==(const OutputList&) const = default;
};

// A name of a file without a folder: no '/', no control characters, at most 255 bytes, not ".", ".." or the
// list itself.
bool is_output_name(std::string_view name);
// Lower-case letters and blanks, at most 32.
bool is_output_kind(std::string_view kind);

// Errors (usage) name `path`. A last line without its end is skipped: it was being written when its run
// ended, and its file was not begun. An empty text is an empty list.
Result<OutputList> parse_output_list(const std::string& text, const std::string& path);
std::string output_list_text(const OutputList& list);

// The process that holds a lock on a file, by the kernel's /proc/locks; 0 where that does not show it.
long lock_holder(const struct stat& file);

}  // namespace kaz::tools
