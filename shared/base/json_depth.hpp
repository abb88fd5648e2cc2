// How deeply a JSON text nests: copies, comparisons and texts of a parsed document recurse once a level.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_JSON_DEPTH_HPP
#define KAZ_SHARED_BASE_JSON_DEPTH_HPP

#include <string_view>

namespace kaz {

// More than any file of ours has; a stack takes some thousand.
inline constexpr int kJsonDepthMax = 64;

// True where brackets nest deeper than `depth_max`. The text need not be valid.
inline bool json_too_deep(std::string_view text, int depth_max = kJsonDepthMax) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > depth_max) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

}  // namespace kaz

#endif
