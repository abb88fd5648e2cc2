// Pictures of two eyes in folders: which left one belongs to which right one.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision/picture_pairs.h"

#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace kaz::tools {
namespace {

// Shorter numbers first: 9 before 10.
struct ByNumber {
  bool operator()(const std::string& a, const std::string& b) const {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  }
};
using Numbered = std::map<std::string, std::string, ByNumber>;

bool digit(char c) {
  return c >= '0' && c <= '9';
}

// The last number in a file's name, without leading zeros; empty where there is none.
std::string number_of(const std::string& path) {
  const std::string name = std::filesystem::path(path).stem().string();
  const auto end = std::find_if(name.rbegin(), name.rend(), digit).base();
  auto begin = end;
  while (begin != name.begin() && digit(*(begin - 1))) --begin;
  while (end - begin > 1 && *begin == '0') ++begin;
  return {begin, end};
}

Result<std::vector<std::string>> matching(const std::string& word, const std::string& option) {
  if (std::filesystem::exists(word)) return std::vector<std::string>{word};
  glob_t found{};
  const int status = ::glob(word.c_str(), 0, nullptr, &found);
  std::vector<std::string> paths(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  if (status == 0 && !paths.empty()) return paths;
  return fail(Fault::usage, "there is no picture '" + word + "'; give " + option +
                                " a file, or a pattern in quotes such as 'eyes/left*.jpg'");
}

Result<Numbered> numbered(const std::vector<std::string>& words, const std::string& option) {
  Numbered pictures;
  for (const auto& word : words) {
    const auto paths = KAZ_TRY(matching(word, option));
    for (const auto& path : paths) {
      const auto [at, added] = pictures.emplace(number_of(path), path);
      if (!added && at->second != path)
        return fail(Fault::usage, "'" + at->second + "' and '" + path + "' of " + option +
                                      (at->first.empty() ? " have no number in their names"
                                                         : " have the same number in their names"));
    }
  }
  return pictures;
}

}  // namespace

Result<std::vector<PicturePair>> find_pairs(const std::vector<std::string>& left,
                                            const std::vector<std::string>& right) {
  const auto lefts = numbered(left, "--left"), rights = numbered(right, "--right");
  if (!lefts) return tl::unexpected(lefts.error());
  if (!rights) return tl::unexpected(rights.error());
  const auto alone = [&](const std::string& path, const char* side) {
    return fail(Fault::usage, "'" + path + "' has no partner with the same number among the " +
                                  side + " pictures (" + std::to_string(lefts->size()) + " left, " +
                                  std::to_string(rights->size()) + " right)");
  };
  std::vector<PicturePair> pairs;
  for (const auto& [number, path] : *lefts) {
    const auto partner = rights->find(number);
    if (partner == rights->end()) return alone(path, "right");
    pairs.push_back({path, partner->second});
  }
  for (const auto& [number, path] : *rights) {
    if (!lefts->contains(number)) return alone(path, "left");
  }
  return pairs;
}

}  // namespace kaz::tools
