// Outcomes of episodes, kept in a file of JSON lines as they come.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "shared/base/result.hpp"
#include "tests/studies/gait/episode.h"

namespace kaz::gait {

struct Key {
  std::string task, stepper;
  std::uint64_t seed = 0;
  auto operator<=>(const Key&) const = default;
};

// An episode that ended in an error has its sentence, and no outcome that counts.
struct Entry {
  Outcome outcome;
  std::string error;
};

class Results {
 public:
  // What the file has; a file that is not there is empty. A last line that was cut off is dropped.
  // Errors: the file is something else, or of other motors.
  static Result<Results> open(const std::string& path, const std::string& motors);

  bool has(const Key& key) const { return entries_.contains(key); }
  // Adds it to the file, too.
  Result<void> add(const Key& key, const Entry& entry);
  // By seed, without those that ended in an error.
  std::vector<Outcome> of(const std::string& task, const std::string& stepper) const;
  int errors(const std::string& task, const std::string& stepper) const;
  bool empty() const { return entries_.empty(); }

 private:
  std::string path_, motors_;
  std::map<Key, Entry> entries_;
};

}  // namespace kaz::gait
