// Dead band: the mean motor voltage at which a shaft at rest begins to turn.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "hil/bench/motor/motor_bench.h"
#include "hil/bench/samples.h"

namespace kaz::hil {
namespace {

constexpr int kFull = 255;     // steps of the duty: what the board can do
constexpr int kMost = 128;     // looked for up to half of it
constexpr int kCoarse = 4;     // steps at a time, first
constexpr double kHold = 0.2;  // s for each
// rad. More than a gear's gap and than noise; a shaft that has broken loose is beyond it by the end of
// a hold, since what kept it back is more than what brakes it then.
constexpr double kMoved = 0.012;
constexpr std::size_t kLast = 6;  // readings at a hold's end
constexpr double kSupplies[] = {4.8, 6.0, 7.2, 8.4, 10.0};

struct Start {
  int step = 0;      // the first at which it turned
  double volts = 0;  // of the supply
};

// From rest, from `first` on by `by` steps.
Start search(MotorOnBench& motor, double sign, int first, int by) {
  motor.go_to(motor.middle_rad() - 0.2 * sign);
  const double from = mean_angle(motor.watch(0.1));
  for (int step = first; step <= kMost; step += by) {
    const Trace trace = motor.drive(sign * step / kFull, kHold);
    check(trace.size() >= kLast, "no readings arrived");
    const Trace end(trace.end() - kLast, trace.end());
    if (sign * (mean_angle(end) - from) > kMoved) return {step, mean_volts(trace, 0, kHold)};
  }
  throw Failed{"the shaft did not turn at half of full duty"};
}

Start find_start(MotorOnBench& motor, double sign) {
  const int near = search(motor, sign, kCoarse, kCoarse).step;
  return search(motor, sign, std::max(1, near - kCoarse), 1);
}

}  // namespace

void measure_dead_band(MotorOnBench& motor, BenchJudge& judge, double supply_volts,
                       std::optional<double> slope_nm_per_v) {
  std::vector<double> volts;
  Series forward{"positive", Series::Style::points, {}},
      backward{"negative", Series::Style::points, {}};
  const auto at_this_supply = [&] {
    for (const double sign : {1.0, -1.0}) {
      const Start start = find_start(motor, sign);
      motor.come_to_rest();
      // It began between this duty and the one before.
      const double mean = (start.step - 0.5) / kFull * start.volts;
      volts.push_back(mean);
      (sign > 0 ? forward : backward).points.emplace_back(start.volts, mean);
    }
  };
  if (motor.has_stand()) {
    for (const double supply : kSupplies) {
      motor.set_supply(supply);
      at_this_supply();
    }
    motor.set_supply(supply_volts);
  } else {
    at_this_supply();
  }
  const Mean mean = mean_of(volts);
  judge.enter(motor.name(), "dead_band", mean.value, mean.error);
  if (slope_nm_per_v) {
    judge.enter(motor.name(), "friction.breakaway", mean.value * *slope_nm_per_v,
                mean.error * *slope_nm_per_v);
  } else {
    judge.leave_out(motor.name(), "friction.breakaway",
                    "this measurement needs a value of stall.slope from the same run");
  }
  judge.add(
      {"dead_band",
       motor.name(),
       "Dead band",
       "supply, V",
       "motor voltage when the shaft begins to turn, V",
       false,
       {forward, backward},
       "Motor voltage (duty times supply) at which the shaft began to turn. At another "
       "supply voltage, this motor voltage differs by at most one duty step (1/255 of the supply "
       "voltage)."});
}

}  // namespace kaz::hil
