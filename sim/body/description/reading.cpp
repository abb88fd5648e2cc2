// Errors and notes about a robot or world file.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/reading.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace kaz::sim {
namespace {

constexpr std::size_t kMaxDetails = 50, kMaxKept = 1000;

}  // namespace

void Objections::add(const std::string& path, int line, const std::string& text) {
  if (found_.size() >= kMaxKept) return;
  std::string shown = text;
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  found_.push_back({path == path_ ? std::string() : path, line, std::move(shown)});
}

Result<void> Objections::result() const {
  if (found_.empty()) return {};
  std::vector<Objection> sorted = found_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Objection& a, const Objection& b) {
    return std::tie(a.path, a.line) < std::tie(b.path, b.line);
  });
  const auto sentence = [this](const Objection& one) {
    return (one.path.empty() ? path_ : one.path) + ":" + std::to_string(one.line) + ": " + one.text;
  };
  Error error{Fault::usage, sentence(sorted.front())};
  for (std::size_t i = 1; i < std::min(sorted.size(), kMaxDetails + 1); ++i)
    error.details.push_back(sentence(sorted[i]));
  if (sorted.size() > kMaxDetails + 1) error.details.push_back("and more errors in this file");
  return tl::unexpected(std::move(error));
}

std::string summary(const std::vector<FileNote>& notes) {
  std::vector<std::pair<std::string, int>> counts;  // in the order of the file
  for (const FileNote& note : notes) {
    const auto known = std::ranges::find(counts, note.what, &std::pair<std::string, int>::first);
    if (known == counts.end())
      counts.emplace_back(note.what, 1);
    else
      ++known->second;
  }
  std::string text;
  for (const auto& [what, count] : counts) {
    text += text.empty() ? what : ", " + what;
    if (count > 1) text += " (" + std::to_string(count) + ")";
  }
  return text;
}

}  // namespace kaz::sim
