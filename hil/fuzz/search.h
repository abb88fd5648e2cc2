// Generates cases from one seed, guided by the behavior that earlier cases caused.
// SPDX-License-Identifier: Apache-2.0
//
// If a case causes a new kind of board behavior, the case is added to the corpus. Most later cases are
// mutations and combinations of cases in the corpus. If the compiler can measure coverage, prefer
// `./tools/dev fuzz`, which is guided by the coverage of the code.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "hil/fuzz/grammar.h"
#include "hil/fuzz/runner.h"
#include "shared/base/random.hpp"

namespace kaz::hil::fuzz {

using CaseRunner = std::function<Result<CaseVerdict>(const Genome&)>;

class Search {
 public:
  explicit Search(std::uint64_t seed) : random_(seed) {}
  void add(Genome genome) { corpus_.push_back(std::move(genome)); }
  // Returns the next case to run.
  Genome next();
  // Processes the verdict on a case. Returns true if the case has new features and was therefore added to the
  // corpus.
  bool learn(const Genome& genome, const CaseVerdict& verdict);
  const std::vector<Genome>& corpus() const { return corpus_; }
  std::size_t features() const { return seen_.size(); }

 private:
  Genome fresh();
  void change(Genome& genome);

  Random random_;
  std::vector<Genome> corpus_;
  std::set<std::uint32_t> seen_;
};

// Shortens a case that violates a rule. The shortened case has at least one byte and still violates a rule,
// but not necessarily the same rule. Runs at most `max_runs` cases.
Genome shortened(const Genome& genome, const CaseRunner& run, int max_runs);

// Reads a genome from a file. The content of the file is the genome. Error messages contain the path and the
// reason.
Result<Genome> load_genome(const std::string& path);
// Writes a genome to the file `name`. If the file exists, a number is appended to the name.
Result<void> save_genome(const std::string& name, const Genome& genome);
// Reads all files of a folder in the order of their names.
Result<std::vector<Genome>> load_corpus(const std::string& folder);

}  // namespace kaz::hil::fuzz
