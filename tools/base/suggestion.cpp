// The name that a mistyped one was meant to be.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/suggestion.h"

#include <algorithm>
#include <utility>

namespace kaz::tools {
namespace {

// Optimal string alignment distance: insertions, deletions, substitutions and swaps of neighbours.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] =
          std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string suggestion(std::string_view given, const std::vector<std::string>& names) {
  constexpr std::size_t kMaxGiven = 64, kNear = 2;
  if (given.size() > kMaxGiven) return "";
  std::pair<std::size_t, std::string> best{kNear + 1, ""};
  for (const std::string& name : names) {
    std::size_t distance = edit_distance(given, name);
    const std::size_t letters = std::ranges::count_if(given, [](char c) { return c != '-'; });
    if (2 * distance > letters) distance = kNear + 1;
    if (letters > 2 && name.starts_with(given)) distance = std::min(distance, kNear);
    best = std::min(best, {distance, name});
  }
  return best.second.empty() ? "" : "; did you mean " + best.second + "?";
}

}  // namespace kaz::tools
