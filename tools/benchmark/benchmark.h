// The benchmark program: names of measurements, groups of measurements, results and their output.
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
  // True: short and imprecise measurements, to test the benchmark program itself.
  bool quick = false;
  int repeats = 5;  // number of runs; each result is the median of the runs
  // Names of the emulator's engines to measure; at least one name.
  std::vector<std::string> engines;
};

// Name and properties of one measurement. `due`: required value; 0: no required value. `aim`: target value;
// 0: no target value.
struct Name {
  std::string name;
  std::string unit;
  double due = 0, aim = 0;
  bool more_is_better = true;
  int decimals = 1;
};
// Returns all measurements, in the order of the table.
const std::vector<Name>& names();

// Values that were measured so far, by name of the measurement.
class Results {
 public:
  void put(const std::string& name, double value) { values_[name] = value; }
  // Adds a note below the table, for example the reason why a result is missing.
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
// Makes a group of measurements that are taken once for each engine of the emulator.
using PerEngine = std::function<Result<void>(const Settings&, const std::string& engine, Results&)>;
Group each_engine(std::vector<std::string> gives, PerEngine measure);

std::vector<Group> emulator_groups();
std::vector<Group> firmware_groups();
std::vector<Group> program_groups();
// Returns the group of `dynamics.step_kinstr.*` and `dynamics.collision_kinstr.*`. These are the thousands of
// instructions per physics step and per collision detection, without loading and settling. If valgrind is
// missing, the group adds a remark instead.
Group counted_steps();

// A load that can run alone, for profilers and for counting host instructions. `amount`: number of rounds of
// a guest program, or time in ms of the firmware.
struct Load {
  std::string_view name;
  std::string_view unit;
  std::function<Result<void>(const std::string& engine, int amount)> run;
};
const std::vector<Load>& loads();
// Runs a guest program of sim/h8s/testdata. `rounds`: 1 to 65535.
Result<void> run_guest(const std::string& guest, const std::string& engine, int rounds);
// Runs the firmware under the load of a walking robot, for `milliseconds` after the firmware's start.
Result<void> run_firmware(const std::string& engine, int milliseconds);

// Counts the host instructions of a load, with perf_event_open or valgrind. Returns the number of
// instructions for the amount `many` minus the number for the amount `few`, so that start-up is not counted.
// If neither perf_event_open nor valgrind works, adds a remark and returns nullopt.
std::optional<double> host_instructions(const std::string& load, const std::string& engine, int few,
                                        int many, Results& results);

// Returns the table as text, in the order of names(), with required and target values.
std::string table(const Results& results, const std::vector<std::string>& engines);
// Writes the results as one JSON object, with one number per name. Replaces the file atomically.
Result<void> write_json(const std::string& path, const Results& results,
                        const std::vector<std::string>& engines);

// Returns the CPU time that this process has used so far, s.
double cpu_seconds();
double median(std::vector<double> values);

}  // namespace kaz::bench
