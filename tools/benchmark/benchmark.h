// The benchmark program: names of measurements, groups that take them, results and their output.
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
  bool quick = false;                // short and imprecise, to test the program itself
  int repeats = 5;                   // number of runs; each result is their median
  std::vector<std::string> engines;  // engines of the emulator; at least one
};

// One measurement. `due`: required value; `aim`: target value. 0 means no such value.
struct Name {
  std::string name;
  std::string unit;
  double due = 0, aim = 0;
  bool more_is_better = true;
  int decimals = 1;
};
// All measurements, in the order of the table.
const std::vector<Name>& names();

// Results so far, by name.
class Results {
 public:
  void put(const std::string& name, double value) { values_[name] = value; }
  // Adds a note below the table: why a result is missing, or how it was measured.
  void remark(const std::string& text);
  std::optional<double> get(std::string_view name) const;
  const std::vector<std::string>& remarks() const { return remarks_; }

 private:
  std::map<std::string, double, std::less<>> values_;
  std::vector<std::string> remarks_;
};

// Measurements that are taken together.
struct Group {
  std::vector<std::string> gives;
  std::function<Result<void>(const Settings&, Results&)> run;
};
// Makes a group that is measured for each engine of the emulator.
using PerEngine = std::function<Result<void>(const Settings&, const std::string& engine, Results&)>;
Group each_engine(std::vector<std::string> gives, PerEngine measure);

std::vector<Group> emulator_groups();
std::vector<Group> firmware_groups();
std::vector<Group> program_groups();
// `dynamics.step_kinstr.*` and `dynamics.collision_kinstr.*`: thousands of instructions per physics step and
// per collision detection, without loading and settling. Without valgrind it adds a remark instead.
Group counted_steps();

// A load that runs by itself, for profilers and for counting host instructions. `amount`: rounds of a guest
// program, or milliseconds of the firmware.
struct Load {
  std::string_view name;
  std::string_view unit;
  std::function<Result<void>(const std::string& engine, int amount)> run;
};
const std::vector<Load>& loads();
// Runs a guest program of sim/h8s/testdata, 1 to 65535 rounds.
Result<void> run_guest(const std::string& guest, const std::string& engine, int rounds);
// Runs the firmware under its walking load for this time after its start.
Result<void> run_firmware(const std::string& engine, int milliseconds);

// Counts the host instructions of a load, by perf_event_open or valgrind. Returns the difference between the
// amounts `many` and `few`, which excludes the start. nullopt: neither works, which adds a remark.
std::optional<double> host_instructions(const std::string& load, const std::string& engine, int few,
                                        int many, Results& results);

// Returns the table as text, in the order of names(), with required and target values.
std::string table(const Results& results, const std::vector<std::string>& engines);
// Writes one JSON object, a number per name. Replaces the file atomically.
Result<void> write_json(const std::string& path, const Results& results,
                        const std::vector<std::string>& engines);

// Returns the CPU time of this process so far, s.
double cpu_seconds();
double median(std::vector<double> values);

}  // namespace kaz::bench
