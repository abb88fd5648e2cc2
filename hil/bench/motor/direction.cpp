// Direction: whether the potentiometer's angle rises under a positive duty, before any loop is closed.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "hil/bench/motor/motor_bench.h"

namespace kaz::hil {
namespace {

constexpr int kFull = 255;     // steps of the duty: what the board can do
constexpr int kMost = 128;     // as far as the dead band is looked for
constexpr int kStep = 4;       // by which it grows
constexpr double kHold = 0.2;  // s for each at most
// rad, at which the drive ends: 2 degrees, five times a healthy gear's play and twenty times the noise of one
// reading.
constexpr double kEnough = 0.035;
constexpr double kTurned = 0.02;  // rad between the means of before and after
constexpr double kLook = 0.05;    // s, ten readings

// The change of the angle by this duty, rad; 0: the shaft did not turn.
double turned_by(MotorOnBench& motor, double duty) {
  const double from = mean_angle(motor.watch(kLook));
  (void)motor.nudge(duty, kHold, from, kEnough);
  const double change = mean_angle(motor.watch(kLook)) - from;
  return std::abs(change) > kTurned ? change : 0;
}

}  // namespace

bool measure_direction(MotorOnBench& motor, BenchJudge& judge, bool enter_good) {
  motor.check_potentiometer();
  // Both sides at each duty: a shaft that rests against an end of its range is pressed against it no harder
  // than it takes to turn it away from there.
  std::array<double, 2> change{};
  for (int step = kStep; step <= kMost && (change[0] == 0 || change[1] == 0); step += kStep) {
    const double duty = static_cast<double>(step) / kFull;
    if (change[0] == 0) change[0] = turned_by(motor, duty);
    if (change[1] == 0) change[1] = turned_by(motor, -duty);
  }
  check(
      change[0] != 0 && change[1] != 0,
      change[0] == 0 && change[1] == 0 ? "the shaft did not turn at half of full duty"
      : change[0] != 0
          ? "up to half of full duty, the shaft turned at positive duty but not at negative duty"
          : "up to half of full duty, the shaft turned at negative duty but not at positive duty");
  check(change[0] * change[1] < 0,
        "the shaft turned in the same direction at positive and at negative duty: remove the load "
        "that turns the shaft, such as a weight");
  if (change[0] < 0) {
    judge.enter_finding(motor.name(), "direction", -1,
                        motor.name() +
                            " turns against its potentiometer: exchange the motor's two wires, or "
                            "the two end wires of the potentiometer");
    return false;
  }
  if (enter_good) judge.enter(motor.name(), "direction", 1);
  return true;
}

}  // namespace kaz::hil
