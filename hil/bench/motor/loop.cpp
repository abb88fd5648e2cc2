// The firmware's loop around the motor: a step of its target, and its answer to sines.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <string>

#include "hil/bench/motor/motor_bench.h"
#include "hil/bench/samples.h"
#include "shared/base/angle.hpp"

namespace kaz::hil {
namespace {

constexpr double kStepWay = 0.3;  // rad
constexpr double kStepSeconds = 0.6;
constexpr double kStepEnd = 0.3;  // s from which on it has come to rest
// Of the step: 15 mrad to either side, more than half of what `step.hunting` may be. So a joint that moves
// within its gear's play, and the potentiometer's noise on it, have settled; the time to get there does not
// depend on when in the tail the outermost reading happens to be.
constexpr double kSettled = 0.05;
constexpr int kStepRounds = 3;       // per direction
constexpr double kAmplitude = 0.05;  // rad
constexpr double kHertz[] = {0.5, 1, 1.5, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20};
constexpr double kLeadIn = 0.5;  // s of each sine that are not looked at

struct StepResponse {
  double rise_ms = 0, overshoot = 0, settling_ms = 0, error_mrad = 0;  // overshoot in percent
  double hunting_mrad = 0;                                             // peak to peak
};

std::string gains_text(const host::Gains& gains) {
  char text[60];
  std::snprintf(text, sizeof text, "%.3g /rad and %.2g s/rad", gains.kp_per_rad,
                gains.kd_s_per_rad);
  return text;
}

// Time, s, at which the response first passes `share` of the step; linear between readings. A joint that
// hunts across a worn gear may be past a small share as the step begins.
double passes(const Trace& trace, double from, double distance, double share) {
  if (!trace.empty() && (trace.front().angle_rad - from) / distance >= share)
    return trace.front().t_s;
  for (std::size_t i = 1; i < trace.size(); ++i) {
    const double before = (trace[i - 1].angle_rad - from) / distance;
    const double here = (trace[i].angle_rad - from) / distance;
    if (before < share && here >= share) {
      const double part = (share - before) / (here - before);
      return trace[i - 1].t_s + part * (trace[i].t_s - trace[i - 1].t_s);
    }
  }
  throw Failed{"the joint did not approach its target"};
}

StepResponse step_response(const Trace& trace, double from, double to) {
  const double distance = to - from;
  std::vector<double> rest;
  for (const Sample& sample : trace) {
    if (sample.t_s >= kStepEnd) rest.push_back(sample.angle_rad);
  }
  check(!rest.empty(), "no readings arrived");
  const double end = mean_of(rest).value;
  const auto [min, max] = std::ranges::minmax(rest);
  StepResponse response;
  response.rise_ms =
      1e3 * (passes(trace, from, distance, 0.9) - passes(trace, from, distance, 0.1));
  response.error_mrad = 1e3 * (end - to);
  response.hunting_mrad = 1e3 * (max - min);
  double max_overshoot = 0;
  for (const Sample& sample : trace) {
    max_overshoot = std::max(max_overshoot, (sample.angle_rad - end) / distance);
    if (std::abs(sample.angle_rad - end) > kSettled * std::abs(distance))
      response.settling_ms = 1e3 * sample.t_s;
  }
  response.overshoot = 100 * max_overshoot;
  return response;
}

// The answer's sine of frequency f: how much and how late, as a complex number.
std::complex<double> component(const Trace& trace, double hertz) {
  // Whole periods: else the mean leaks into it.
  const double end = trace.back().t_s;
  const double begin = end - std::floor((end - kLeadIn) * hertz) / hertz;
  double mean = 0;
  int count = 0;
  for (const Sample& sample : trace) {
    if (sample.t_s < begin) continue;
    mean += sample.angle_rad;
    ++count;
  }
  check(count > 3, "too few readings arrived during a sinusoidal motion");
  mean /= count;
  std::complex<double> sum = 0;
  for (const Sample& sample : trace) {
    if (sample.t_s < begin) continue;
    sum += (sample.angle_rad - mean) * std::polar(1.0, -2 * std::numbers::pi * hertz * sample.t_s);
  }
  return sum / static_cast<double>(count);
}

// Where the gain first falls below `level`, between two frequencies on a logarithmic scale.
double crossing(const Points& gain_db, double level) {
  for (std::size_t i = 1; i < gain_db.size(); ++i) {
    const auto& [f0, g0] = gain_db[i - 1];
    const auto& [f1, g1] = gain_db[i];
    if (g0 >= level && g1 < level)
      return std::exp(std::log(f0) + (g0 - level) / (g0 - g1) * std::log(f1 / f0));
  }
  return gain_db.back().second >= level ? gain_db.back().first : gain_db.front().first;
}

}  // namespace

void measure_step(MotorOnBench& motor, BenchJudge& judge) {
  std::vector<double> rise, overshoot, settling, error, hunting;
  Series up{"up", Series::Style::line, {}}, down{"down, inverted", Series::Style::line, {}};
  motor.go_to(motor.middle_rad() - 0.5 * kStepWay);
  for (int round = 0; round < kStepRounds; ++round) {
    for (const double sign : {1.0, -1.0}) {
      const double from = motor.middle_rad() - sign * 0.5 * kStepWay;
      const double to = motor.middle_rad() + sign * 0.5 * kStepWay;
      const Trace trace = motor.step(from, to, kStepSeconds);
      check(!trace.empty(), "no readings arrived");
      const StepResponse response = step_response(trace, from, to);
      rise.push_back(response.rise_ms);
      overshoot.push_back(response.overshoot);
      settling.push_back(response.settling_ms);
      error.push_back(std::abs(response.error_mrad));
      hunting.push_back(response.hunting_mrad);
      if (round > 0) continue;
      for (const Sample& sample : trace)
        (sign > 0 ? up : down)
            .points.emplace_back(1e3 * sample.t_s, sign * (sample.angle_rad - from));
    }
  }
  const auto enter = [&](const char* name, const std::vector<double>& values) {
    const Mean mean = mean_of(values);
    judge.enter(motor.name(), name, mean.value, mean.error);
  };
  enter("step.rise_time", rise);
  enter("step.overshoot", overshoot);
  enter("step.settling_time", settling);
  enter("step.error", error);
  enter("step.hunting", hunting);
  judge.add({"step",
             motor.name(),
             "Step of the target",
             "time, ms",
             "displacement, rad",
             false,
             {up, down, {"target", Series::Style::dashed, {{0, kStepWay}, {600, kStepWay}}}},
             "The response to a step of 0.3 rad, with " + gains_text(motor.gains()) +
                 " and the board's ramp limit of 6 rad/s."});
}

void measure_frequency(MotorOnBench& motor, BenchJudge& judge) {
  Points gain, phase;
  double phase_2hz = 0;
  motor.go_to(motor.middle_rad());
  double before = 0;
  for (const double hertz : kHertz) {
    const double seconds = kLeadIn + std::max(1.0, 4 / hertz);
    const auto sine = motor.follow(motor.middle_rad(), kAmplitude, hertz, seconds);
    const std::complex<double> ratio =
        component(sine.answer, hertz) / component(sine.target, hertz);
    check(std::isfinite(std::abs(ratio)), "the joint did not respond");
    gain.emplace_back(hertz, 20 * std::log10(std::abs(ratio)));
    double degrees = std::arg(ratio) / kDegree;
    // Without a jump where it passes half a turn.
    while (degrees > before + 180) degrees -= 360;
    while (degrees < before - 180) degrees += 360;
    before = degrees;
    phase.emplace_back(hertz, degrees);
    if (hertz == 2) phase_2hz = degrees;
  }
  judge.enter(motor.name(), "frequency.bandwidth", crossing(gain, -3));
  judge.enter(motor.name(), "frequency.phase_2hz", phase_2hz);
  judge.add(
      {"gain",
       motor.name(),
       "Frequency response: gain",
       "frequency, Hz",
       "gain, dB",
       true,
       {{"response over target", Series::Style::line, gain},
        {"-3 dB", Series::Style::dashed, {{kHertz[0], -3}, {kHertz[std::size(kHertz) - 1], -3}}}},
       "The targets follow a sine with an amplitude of 0.05 rad. A target is sent every 10 ms, "
       "with " +
           gains_text(motor.gains()) + "."});
  judge.add({"phase",
             motor.name(),
             "Frequency response: phase",
             "frequency, Hz",
             "phase, degrees",
             true,
             {{"response against target", Series::Style::line, phase}},
             "The phase includes the 10 ms ramp to each target."});
}

}  // namespace kaz::hil
