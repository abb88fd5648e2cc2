// Cases from one seed, guided by what they made the board do.
// SPDX-License-Identifier: Apache-2.0
//
// A case that shows something new (its features) joins the corpus, and later cases are made by
// changing and
// joining those. Where the compiler can measure coverage, `./tools/dev fuzz` is better.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "hil/fuzz/grammar.h"
#include "hil/fuzz/runner.h"
#include "shared/base/random.hpp"

namespace kaz::hil::fuzz {

using CaseRunner = std::function<Result<Verdict>(const Genome&)>;

class Search {
 public:
  explicit Search(std::uint64_t seed) : random_(seed) {}
  void add(Genome genome) { corpus_.push_back(std::move(genome)); }
  // The next case to be run.
  Genome next();
  // What it came to. True if it showed something new, and so is in the corpus now.
  bool learn(const Genome& genome, const Verdict& verdict);
  const std::vector<Genome>& corpus() const { return corpus_; }
  std::size_t features() const { return seen_.size(); }

 private:
  Genome fresh();
  void change(Genome& genome);

  Random random_;
  std::vector<Genome> corpus_;
  std::set<std::uint32_t> seen_;
};

// A shorter case that is wrong too, of a byte at least, after at most `max_runs` runs.
Genome shortened(const Genome& genome, const CaseRunner& run, int max_runs);

// Corpus and reproducers: a file is a genome. Errors say which path, and why.
Result<Genome> load_genome(const std::string& path);
// At `name`, or with a number after it where that is taken.
Result<void> save_genome(const std::string& name, const Genome& genome);
// All files of a folder, in order of their names.
Result<std::vector<Genome>> load_corpus(const std::string& folder);

}  // namespace kaz::hil::fuzz
