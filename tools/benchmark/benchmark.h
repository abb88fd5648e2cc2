// What the benchmark program measures: names, how each is taken, where the results go.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::bench {

struct Settings {
  bool quick = false;                // short and rough: for a test that it works at all
  int repeats = 5;                   // medians of so many
  std::vector<std::string> engines;  // of the emulator; at least one
};

// One number. `due` and `aim` as the project set them; 0 where there is none.
struct Name {
  std::string name;
  std::string unit;
  double due = 0, aim = 0;
  bool more_is_better = true;
  int decimals = 1;
};
// All names there are, in the order of the table.
const std::vector<Name>& names();

// Numbers taken so far, by name.
class Results {
 public:
  void put(const std::string& name, double value) { values_[name] = value; }
  // A word on why a number is missing or how it was taken, below the table.
  void remark(const std::string& text);
  std::optional<double> get(std::string_view name) const;
  const std::vector<std::string>& remarks() const { return remarks_; }

 private:
  std::map<std::string, double, std::less<>> values_;
  std::vector<std::string> remarks_;
};

// Measures one or several names at once.
struct Group {
  std::vector<std::string> gives;
  std::function<Result<void>(const Settings&, Results&)> run;
};
// A group of numbers that each engine of the emulator gives.
using PerEngine = std::function<Result<void>(const Settings&, const std::string& engine, Results&)>;
Group each_engine(std::vector<std::string> gives, PerEngine measure);

std::vector<Group> emulator_groups();
std::vector<Group> firmware_groups();
std::vector<Group> program_groups();

// A load by itself, for profilers and for counting host instructions: `amount` rounds of a guest
// program, or milliseconds of the firmware.
struct Load {
  std::string_view name;
  std::string_view unit;
  std::function<Result<void>(const std::string& engine, int amount)> run;
};
const std::vector<Load>& loads();

// CPU time that this process has used, s.
double cpu_seconds();
double median(std::vector<double> values);

}  // namespace kaz::bench
