// For tests: runs the bench groups `link` and `tick` on a board, and finds results by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "hil/bench/link_bench.h"
#include "hil/bench/tick_bench.h"
#include "sim/mcu/mcu.h"
#include "tools/lockstep/virtual_bench.h"

namespace kaz::hil {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Names = std::set<std::string>;

// Returns the names of the measurements with this verdict.
inline Names names_with(const BenchReport& report, Verdict verdict) {
  Names names;
  for (const Measurement& one : report.measurements) {
    if (one.verdict == verdict) names.insert(one.of->name);
  }
  return names;
}
inline Names failed(const BenchReport& report) {
  return names_with(report, Verdict::failed);
}

inline Names names_of(BenchGroup group) {
  Names names;
  for (const MeasurementInfo& info : measurement_infos()) {
    if (info.group == group) names.insert(info.name);
  }
  return names;
}

// Returns the value of a measurement. Reports a test failure if it is missing.
inline double value(const BenchReport& report, const std::string& name) {
  for (const Measurement& one : report.measurements) {
    if (one.of->name == name) return one.value;
  }
  ADD_FAILURE() << name << " was not measured";
  return 0;
}

inline std::string all_values(const BenchReport& report) {
  std::string text;
  for (const Measurement& one : report.measurements) {
    text += one.of->name + " " + std::to_string(one.value) + " " + one.message + "\n";
  }
  return text;
}

// These measure without limits and report errors as test failures.
inline BenchReport measure_link(host::Link& link, host::Clock& clock,
                                const LinkBenchOptions& options = {}) {
  BenchReport report;
  const Limits none;
  BenchJudge judge(report, none);
  const auto measured = bench_link(link, clock, options, judge);
  EXPECT_TRUE(measured) << measured.error().message;
  return report;
}

inline BenchReport measure_tick(host::Link& link, host::Clock& clock,
                                const TickBenchOptions& options = {}) {
  BenchReport report;
  const Limits none;
  BenchJudge judge(report, none);
  const auto measured = bench_tick(link, clock, options, judge);
  EXPECT_TRUE(measured) << measured.error().message;
  return report;
}

}  // namespace kaz::hil
