// A report made up.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/report/report_testing.h"

#include <cmath>
#include <limits>

namespace kaz::hil {

BenchReport test_report() {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  BenchReport report;
  report.board = "Kaz servo board <1>";
  report.port = "/dev/tty&0";
  report.program = "kaz 0.1.0";
  report.seed = 18446744073709551615u;
  report.seconds = 12.25;
  report.conditions = {{"disc, kg m2", 1.25e-4}, {"supply, V", 10}};
  const Limits limits = {{"pot.offset", {-kInfinite, kInfinite}}};
  BenchJudge judge(report, limits);
  judge.enter("neck_pan", "stall.torque_4v8", 0.97, 0.004);
  judge.enter("neck_pan", "pot.noise", 1.7, 0, "less < more & \"quoted\", with a comma");
  judge.enter("neck_pan", "pot.offset", -0.1234567890123);
  judge.enter("neck_pan", "frequency.bandwidth", kInfinite);
  judge.enter("neck_pan", "backlash", std::nan(""));
  judge.leave_out("neck_pan", "stall.slope", "needs --allow-motion");
  judge.enter("link", "link.cycle_rate", 100.5);
  judge.enter("board", "tick.missed", 0);
  judge.enter("board", "tick.clock_error", -250.5, 3);

  Plot stall{"stall", "neck_pan", "Torque & volts", "motor voltage, V", "torque, Nm",
             false,   {},         "A line."};
  stall.series = {{"points", Series::Style::points, {{1, 0.1}, {2, 0.35}, {3, std::nan("")}}},
                  {"line \"1\"", Series::Style::line, {{0, -0.128}, {4, 0.8}}},
                  {"paper", Series::Style::dashed, {{4.8, 0.97}, {-kInfinite, 1}}}};
  judge.add(stall);
  judge.add({"phase",
             "link",
             "Phase",
             "frequency, Hz",
             "phase, deg",
             true,
             {{"", Series::Style::line, {{0.1, 0}, {1, -10}, {20, -170}}}},
             ""});
  return report;
}

}  // namespace kaz::hil
