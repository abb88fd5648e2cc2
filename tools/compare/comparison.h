// Compares two runs: finds measures that differ by more than the scatter within each run.
// SPDX-License-Identifier: Apache-2.0
// A run is divided into eight blocks of time. Each measure is computed for the whole run, and eight more
// times with one block left out. The scatter of these eight values gives the measure's standard error by the
// delete-a-block jackknife. Source: Künsch, The jackknife and the bootstrap for general stationary
// observations, 1989. Two values differ if two conditions are met: Welch's test at 0.1 % rejects equality,
// and the difference exceeds the measure's resolution. A joint's lag is left out if the motion does not
// determine the lag.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shared/plot/plot.h"
#include "tools/compare/run_trace.h"

namespace kaz::tools {

struct Measured {
  bool known = false;
  double value = 0;
  double error = 0;  // standard error of `value`; 0 for counts
};

struct Measure {
  std::string name;     // for example "l_knee.lag"
  std::string unit;     // unit of the value, for example "ms"; empty for counts
  std::string meaning;  // explanation for users: "delay of the joint behind its command"
  double resolution = 0;
  Measured a, b;
  // Reason why the runs do not determine the value; empty if both runs determine the value.
  std::string left_out = {};
  // Whether the value is a count of rare, independent events on the line.
  bool rare = false;
  bool comparable() const { return a.known && b.known; }
  double difference() const { return b.value - a.value; }
  // Limit of the absolute difference() above which differs() returns true.
  double threshold() const;
  bool differs() const;
};

struct Comparison {
  std::vector<Measure> measures;
  // Reasons why the runs are only partly comparable: differences of behavior, options, start posture or
  // targets; an early end; shutdowns.
  std::vector<std::string> notes;
  // Time until which the host sent the same targets to both robots. After this time, different angles may be
  // caused by different targets.
  double same_targets_s = 0;
  int differing() const;
};

// If a run does not determine a value, Measured::known is false; this is no error.
Comparison compare(const RunTrace& a, const RunTrace& b);

// Commanded angle of a joint over time, in steps of 1 ms from the joint's first target on. `angle_rad` is
// empty if there was no target.
struct CommandCurve {
  double start_s = 0;
  std::vector<double> angle_rad;
  // Returns false if time_s is below start_s: no command was sent yet. After the last step, the last angle
  // stays valid.
  bool covers(double time_s) const { return !angle_rad.empty() && time_s >= start_s; }
  double at(double time_s) const;
};
CommandCurve command_curve(const RunTrace& trace, int joint);

// `width`: width of the terminal (list_row()).
std::string comparison_text(const Comparison& comparison, const RunTrace& a, const RunTrace& b,
                            bool all, std::size_t width = 0);
nlohmann::ordered_json comparison_json(const Comparison& comparison, const RunTrace& a,
                                       const RunTrace& b);
// Returns a plot of each joint that moved, with the command of A and the angles of A and B. Also returns
// plots of supply voltage, round-trip times and delays of pictures.
std::vector<plot::PlotPage> comparison_plots(const RunTrace& a, const RunTrace& b);

}  // namespace kaz::tools
