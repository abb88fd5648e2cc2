// Backlash: how far the shaft yields to gentle presses from both sides.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "hil/bench/motor/motor_bench.h"
#include "hil/bench/samples.h"
#include "shared/base/angle.hpp"

namespace kaz::hil {
namespace {

// Well below what turns the motor through its gear, far above what a disc needs.
constexpr double kPress = 0.03;  // Nm
// Each reading is off by half a code: some thousand of them resolve a hundredth of that.
constexpr int kRounds = 8;
constexpr double kWatched = 2;         // s
constexpr std::ptrdiff_t kShown = 20;  // readings to a point of the plot

}  // namespace

void measure_backlash(MotorOnBench& motor, BenchJudge& judge) {
  Stand& stand = motor.stand();
  const auto pressed = [&](double torque) {
    sure(stand.press(motor.joint(), torque));
    motor.wait(stand.settling_s());
    return motor.watch(kWatched);
  };
  Series shown{"angle", Series::Style::line, {}};
  double at = 0;
  // Means of 0.1 s: single readings jump by whole codes.
  const auto show = [&](const Trace& trace) {
    for (auto first = trace.begin(); trace.end() - first >= kShown; first += kShown) {
      shown.points.emplace_back(at + first->t_s, mean_angle({first, first + kShown}) / kDegree);
    }
    at += kWatched;
  };
  std::vector<double> ways;
  for (int round = 0; round < kRounds; ++round) {
    const Trace back = pressed(-kPress), forth = pressed(kPress);
    show(back);
    show(forth);
    ways.push_back((mean_angle(forth) - mean_angle(back)) / kDegree);
  }
  sure(stand.press(motor.joint(), 0));
  const Mean play = mean_of(ways);
  judge.enter(motor.name(), "backlash", play.value, play.error);
  judge.add({"backlash",
             motor.name(),
             "Backlash",
             "time pressed, s",
             "reported angle, degrees",
             false,
             {shown},
             "The motor is off, and a torque of 0.03 Nm presses the shaft alternately backward and "
             "forward. The angle between the two positions is the backlash. Each point is a mean "
             "over 0.1 s."});
}

}  // namespace kaz::hil
