// Speed without load against motor voltage, and how a start lags behind it.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include "hil/bench/motor/motor_bench.h"
#include "hil/bench/samples.h"

namespace kaz::hil {
namespace {

// In 255ths, as the board has them.
constexpr double kDuties[] = {77. / 255, 115. / 255, 153. / 255, 204. / 255, 1};
constexpr int kFullStarts = 4;  // more of them, per direction: the start's lag is a small number
constexpr double kFromLimit = 0.08;  // rad, where a run begins
constexpr double kSteady = 0.06;     // s after which the start is over
constexpr double kPress = 0.03;      // Nm, to begin with the gear's flanks on the driving side
constexpr double kAtVolts = 10;
constexpr double kShown = 0.06;     // s, of a start
constexpr std::size_t kFewest = 6;  // readings at steady speed

// Where a run is broken off, rad before the limit: near one the board holds fast joints back, and the disc
// runs on. A motor of this kind turns at no more than 1.4 rad/s for each volt.
double stop_before(double volts) {
  return 0.15 + 0.06 * 1.4 * std::abs(volts);
}

struct Run {
  double volts = 0;  // mean motor voltage, signed
  double speed = 0;  // rad/s, signed
  double lag = 0;    // s
  Trace trace;
  double from = 0;  // rad
};

// Nothing: the joint's range is too short for a steady speed at this duty.
std::optional<Run> run_once(MotorOnBench& motor, double duty, double supply_volts) {
  const double sign = duty > 0 ? 1 : -1;
  const double start = sign > 0 ? motor.lower_rad() + kFromLimit : motor.upper_rad() - kFromLimit;
  motor.go_to(start);
  if (motor.has_stand()) {
    sure(motor.stand().press(motor.joint(), -sign * kPress));
    motor.wait(motor.stand().settling_s());
    sure(motor.stand().press(motor.joint(), 0));
    motor.wait(0.1);
  }
  Run run;
  run.from = mean_angle(motor.watch(0.3));
  run.trace = motor.drive(duty, 1.9, stop_before(duty * supply_volts));
  Points steady;
  for (const Sample& sample : run.trace) {
    if (sample.t_s >= kSteady) steady.emplace_back(sample.t_s, sample.angle_rad);
  }
  if (steady.size() < kFewest) return std::nullopt;
  const Line line = fit_line(steady);
  check(sign * line.slope > 0.1, "the shaft did not turn in the driven direction");
  run.speed = line.slope;
  run.lag = (run.from - line.at_zero) / line.slope;
  run.volts = duty * mean_volts(run.trace, kSteady, 10);
  return run;
}

Plot speed_plot(const std::string& joint, const Points& points, const Line& line) {
  Series measured{"measured", Series::Style::points, points};
  Series fitted{"line", Series::Style::line, {}};
  for (const double volts : {0.0, 11.0})
    if (line(volts) >= 0 || volts > 0) fitted.points.emplace_back(volts, line(volts));
  if (fitted.points.size() < 2)
    fitted.points.insert(fitted.points.begin(), {-line.at_zero / line.slope, 0});
  return {"no_load",
          joint,
          "Speed without load",
          "motor voltage, V",
          "speed, rad/s",
          false,
          {measured, fitted},
          "The plot shows both directions. The line reaches zero speed at a certain voltage. At "
          "this voltage, the motor's torque equals the sliding friction."};
}

Plot start_plot(const std::string& joint, const Run& run) {
  Series measured{"angle", Series::Style::points, {}},
      steady{"steady speed", Series::Style::dashed, {}};
  for (const Sample& sample : run.trace) {
    if (sample.t_s < kShown)
      measured.points.emplace_back(1e3 * sample.t_s, sample.angle_rad - run.from);
  }
  for (const double t : {run.lag, kShown})
    steady.points.emplace_back(1e3 * t, run.speed * (t - run.lag));
  return {"start",
          joint,
          "Start at full duty",
          "time, ms",
          "displacement, rad",
          false,
          {measured, steady},
          "The dashed line shows the motion at steady speed. The lag is the time at which the "
          "dashed line has zero displacement. The lag comes from the inertia of rotor and disc, "
          "the backlash of the gear, and the board's tick."};
}

}  // namespace

void measure_speed(MotorOnBench& motor, BenchJudge& judge, std::optional<double> slope_nm_per_v) {
  Points points;
  std::vector<double> lags;
  Run shown;
  const double supply = mean_volts(motor.watch(0.1), 0, 1);
  for (const double duty : kDuties) {
    for (int round = 0; round < (duty == 1 ? kFullStarts : 1); ++round) {
      for (const double sign : {1.0, -1.0}) {
        const auto run = run_once(motor, sign * duty, supply);
        if (!run) continue;
        points.emplace_back(sign * run->volts, sign * run->speed);
        // The lag is that of the fastest: the gap of the gear is the smallest part of it.
        if (std::abs(run->volts) > 1.05 * std::abs(shown.volts)) lags.clear();
        if (std::abs(run->volts) > 0.95 * std::abs(shown.volts)) lags.push_back(1e3 * run->lag);
        if (run->volts > std::abs(shown.volts)) shown = *run;
      }
    }
  }
  check(points.size() >= 4, "the joint's range is too short for a steady speed");
  const Line line = fit_line(points);
  const Mean lag = mean_of(lags);
  judge.enter(motor.name(), "no_load.speed", line(kAtVolts),
              std::hypot(line.at_zero_error, kAtVolts * line.slope_error));
  judge.enter(motor.name(), "no_load.slope", line.slope, line.slope_error);
  // What the limits are for.
  constexpr double kDisc = 4e-4;
  const double disc = motor.has_stand() ? sure(motor.stand().disc_kgm2()) : kDisc;
  if (std::abs(disc / kDisc - 1) > 0.05) {
    judge.enter_without_default_limits(
        motor.name(), "start.time_constant", lag.value, lag.error,
        "not judged, because the default limits assume a disc with an inertia of 4e-4 kg m2");
  } else {
    judge.enter(motor.name(), "start.time_constant", lag.value, lag.error);
  }
  if (slope_nm_per_v) {
    const double worth = *slope_nm_per_v / line.slope;
    judge.enter(motor.name(), "friction.running", -line.at_zero * worth,
                line.at_zero_error * worth);
  } else {
    judge.leave_out(motor.name(), "friction.running",
                    "this measurement needs a value of stall.slope from the same run");
  }
  judge.add(speed_plot(motor.name(), points, line));
  judge.add(start_plot(motor.name(), shown));
}

}  // namespace kaz::hil
