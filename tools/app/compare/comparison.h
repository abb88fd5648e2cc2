// Compares two runs: finds measures that differ by more than the scatter within each run.
// SPDX-License-Identifier: Apache-2.0
// Each measure is computed for the whole run, and again without each of eight blocks of its time. The scatter
// of these values gives its standard error (delete-a-block jackknife: Künsch, The jackknife and the bootstrap
// for general stationary observations, 1989). Two values differ if Welch's test at 0.1 % rejects equality,
// and if their distance exceeds the measure's resolution. A lag is left out if the motion does not determine
// it.
// determine it.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shared/plot/plot.h"
#include "tools/app/compare/run_trace.h"

namespace kaz::tools {

struct Measured {
  bool known = false;
  double value = 0;
  double error = 0;  // standard error; 0 for counts
};

struct Measure {
  std::string name;     // "l_knee.lag"
  std::string unit;     // "ms"; empty for counts
  std::string meaning;  // for users: "delay of the joint behind its command"
  double resolution = 0;
  Measured a, b;
  std::string left_out = {};  // why the runs do not determine the value; else empty
  bool rare = false;          // count of rare, independent events on the line
  bool comparable() const { return a.known && b.known; }
  double difference() const { return b.value - a.value; }
  // Smallest difference that counts as one.
  double threshold() const;
  bool differs() const;
};

struct Comparison {
  std::vector<Measure> measures;
  std::vector<std::string> notes;  // reasons why the runs are incomparable, or equal conditions
  // Time until which the host sent the same targets to both robots. Later differences of angles may come from
  // the host.
  double same_targets_s = 0;
  int differing() const;
};

// Values that a run does not determine are not known; this is no error.
Comparison compare(const RunTrace& a, const RunTrace& b);

// Commanded angle of a joint, in steps of 1 ms from its first target on. Empty if there was no target.
struct CommandCurve {
  double start_s = 0;
  std::vector<double> angle_rad;
  // There is no command before the start. After the end the last value holds.
  bool covers(double time_s) const { return !angle_rad.empty() && time_s >= start_s; }
  double at(double time_s) const;
};
CommandCurve command_curve(const RunTrace& trace, int joint);

// `width`: width of the terminal (list_row()).
std::string comparison_text(const Comparison& comparison, const RunTrace& a, const RunTrace& b,
                            bool all, std::size_t width = 0);
nlohmann::ordered_json comparison_json(const Comparison& comparison, const RunTrace& a,
                                       const RunTrace& b);
// Plots joints that moved (command of A, both angles), supply, round trips and delays of pictures.
std::vector<plot::PlotPage> comparison_plots(const RunTrace& a, const RunTrace& b);

}  // namespace kaz::tools
