// Two runs side by side: what differs by more than the scatter inside each of them.
// SPDX-License-Identifier: Apache-2.0
//
// Each measure is computed of the whole run and once more without each of eight blocks of its time. From how
// much these differ follows its standard error (delete-a-block jackknife: Künsch, The jackknife and the
// bootstrap for general stationary observations, 1989). Two values differ if Welch's test at 0.1 % says so
// and they are further apart than the measure's resolution. A lag is left out where the motion does not
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
  double error = 0;  // standard error; 0: counted
};

struct Measure {
  std::string name;     // "l_knee.lag"
  std::string unit;     // "ms"; empty for counts
  std::string meaning;  // what a person asks: "how far the joint is behind its command"
  double resolution = 0;
  Measured a, b;
  std::string left_out = {};  // why it is not known, where the runs do not determine it; else empty
  bool rare = false;          // a count of what befalls a line now and then
  bool comparable() const { return a.known && b.known; }
  double difference() const { return b.value - a.value; }
  // Of the difference, at which it would be just noticed.
  double threshold() const;
  bool differs() const;
};

struct Comparison {
  std::vector<Measure> measures;
  std::vector<std::string> notes;  // what makes the runs incomparable, or was alike
  // Until then the host sent both robots the same targets; later differences of angles may be the host's.
  double same_targets_s = 0;
  int differing() const;
};

// Errors: none; what cannot be measured in a run is not known there.
Comparison compare(const RunTrace& a, const RunTrace& b);

// What a joint was commanded to, at steps of 1 ms from the first target on; empty if it never was.
struct CommandCurve {
  double start_s = 0;
  std::vector<double> angle_rad;
  // Nothing is commanded before the start; after the end the last holds.
  bool covers(double time_s) const { return !angle_rad.empty() && time_s >= start_s; }
  double at(double time_s) const;
};
CommandCurve command_curve(const RunTrace& trace, int joint);

// `width`: of the terminal (list_row).
std::string comparison_text(const Comparison& comparison, const RunTrace& a, const RunTrace& b,
                            bool all, std::size_t width = 0);
nlohmann::ordered_json comparison_json(const Comparison& comparison, const RunTrace& a,
                                       const RunTrace& b);
// Joints that moved (command of A, both angles), supply, round trips, delays of pictures.
std::vector<plot::PlotPage> comparison_plots(const RunTrace& a, const RunTrace& b);

}  // namespace kaz::tools
