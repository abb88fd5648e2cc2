// Mutation, novelty, shortening.
// SPDX-License-Identifier: Apache-2.0
#include "hil/fuzz/search.h"
#include "shared/base/files.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>

namespace kaz::hil::fuzz {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kLongest = 600;

}  // namespace

Genome Search::fresh() {
  Genome genome(20 + random_.below(280));
  for (std::uint8_t& byte : genome) byte = static_cast<std::uint8_t>(random_.below(256));
  return genome;
}

void Search::change(Genome& genome) {
  const auto at = [&] {
    return static_cast<std::ptrdiff_t>(
        random_.below(static_cast<std::uint32_t>(genome.size()) + 1));
  };
  const auto byte = [&] { return static_cast<std::uint8_t>(random_.below(256)); };
  switch (random_.below(5)) {
    case 0:
      if (!genome.empty())
        genome[random_.below(static_cast<std::uint32_t>(genome.size()))] = byte();
      break;
    case 1:
      genome.insert(genome.begin() + at(), byte());
      break;
    case 2: {
      const auto from = at();
      const auto length = std::min<std::ptrdiff_t>(
          1 + random_.below(16), static_cast<std::ptrdiff_t>(genome.size()) - from);
      genome.erase(genome.begin() + from, genome.begin() + from + length);
      break;
    }
    case 3: {
      const Genome& other = corpus_[random_.below(static_cast<std::uint32_t>(corpus_.size()))];
      const auto from = random_.below(static_cast<std::uint32_t>(other.size()) + 1);
      const Genome tail(other.begin() + from, other.end());
      genome.resize(static_cast<std::size_t>(at()));
      genome.insert(genome.end(), tail.begin(), tail.end());
      break;
    }
    default:
      for (unsigned left = 1 + random_.below(16); left > 0; --left)
        genome.insert(genome.begin() + at(), byte());
  }
}

Genome Search::next() {
  if (corpus_.empty() || random_.chance(0.1)) return fresh();
  Genome genome = corpus_[random_.below(static_cast<std::uint32_t>(corpus_.size()))];
  for (unsigned left = 1 + random_.below(5); left > 0; --left) change(genome);
  if (genome.size() > kLongest) genome.resize(kLongest);
  return genome;
}

bool Search::learn(const Genome& genome, const CaseVerdict& verdict) {
  bool fresh_feature = false;
  for (const std::uint32_t feature : verdict.features)
    fresh_feature |= seen_.insert(feature).second;
  if (fresh_feature) corpus_.push_back(genome);
  return fresh_feature;
}

Genome shortened(const Genome& genome, const CaseRunner& run, int max_runs) {
  Genome best = genome;
  const auto fails = [&](const Genome& candidate) {
    if (candidate.empty() || max_runs-- <= 0) return false;
    const auto verdict = run(candidate);
    return verdict && verdict->violation;
  };
  for (std::size_t chunk = std::max<std::size_t>(best.size() / 2, 1); chunk > 0; chunk /= 2) {
    for (std::size_t at = 0; at < best.size();) {
      Genome candidate = best;
      const auto from = candidate.begin() + static_cast<std::ptrdiff_t>(at);
      candidate.erase(from, from + static_cast<std::ptrdiff_t>(std::min(chunk, best.size() - at)));
      if (fails(candidate)) {
        best = candidate;
      } else {
        at += chunk;
      }
    }
  }
  return best;
}

Result<Genome> load_genome(const std::string& path) {
  constexpr std::size_t max_bytes = 1 << 20;
  const auto bytes = KAZ_TRY(read_whole_file(path, max_bytes, "give a case written by kaz fuzz"));
  return Genome(bytes.begin(), bytes.end());
}

Result<void> save_genome(const std::string& name, const Genome& genome) {
  std::string path = name;
  std::error_code error;
  for (int n = 2; fs::exists(fs::symlink_status(path, error)); ++n)
    path = name + "-" + std::to_string(n);
  return write_whole_file(path, {reinterpret_cast<const char*>(genome.data()), genome.size()});
}

Result<std::vector<Genome>> load_corpus(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_regular_file()) paths.push_back(entry.path().string());
  }
  if (error)
    return fail(Fault::usage, "--corpus " + folder + ": " + error.message() +
                                  "; give a folder that can be read and written");
  std::sort(paths.begin(), paths.end());
  std::vector<Genome> corpus;
  for (const std::string& path : paths) {
    auto genome = KAZ_TRY(load_genome(path));
    corpus.push_back(std::move(genome));
  }
  return corpus;
}

}  // namespace kaz::hil::fuzz
