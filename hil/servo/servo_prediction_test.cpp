// Predictions of a pendulum, checked by closed forms.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_prediction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/servo/truth_log_testing.h"

namespace kaz::hil {
namespace {

// Without friction and motor a small swing has the period 2 pi sqrt(J / (m g l)).
TEST(Pendulum, SwingsWithItsPeriod) {
  ServoLog log = still_pendulum(4);
  for (ServoSample& one : log.samples) one.torque_on = false;
  log.samples[0].position_rad = 0.05;
  ServoParams p;
  p.base = p.viscous = 0;
  const Prediction made = predict(1, p, log);
  const double rate = std::sqrt(log.gravity_nm() / (log.load_kgm2() + p.armature));
  for (std::size_t i = 0; i < log.samples.size(); ++i)
    EXPECT_NEAR(made.position_rad[i], 0.05 * std::cos(rate * log.samples[i].time_s), 1.5e-3);
}

// Held by friction it does not creep, and hangs from its goal by what weight, gain and friction leave.
TEST(Pendulum, StopsWhereFrictionHoldsIt) {
  ServoLog log = still_pendulum(6);
  for (ServoSample& one : log.samples) one.goal_rad = 1;
  ServoParams p;
  const Prediction made = predict(1, p, log);
  const double end = made.position_rad.back(),
               before = made.position_rad[made.position_rad.size() / 2];
  EXPECT_NEAR(end, before, 1e-6);
  const double torque = p.kt * 12 * 4 * (1 - end) / p.resistance;
  EXPECT_LE(std::abs(torque - log.gravity_nm() * std::sin(end)), p.base * 1.001);
  EXPECT_NEAR(made.current_a.back(), 12 * 4 * (1 - end) / p.resistance, 1e-3);
}

// Goals act late by the delay, and the rig's zero shifts readings and nothing else.
TEST(Pendulum, FollowsDelayedGoalsAroundItsZero) {
  ServoLog log = still_pendulum(2);
  for (std::size_t i = 50; i < log.samples.size(); ++i) log.samples[i].goal_rad = 0.5;
  ServoLog late = log, shifted = log;
  for (std::size_t i = 50; i < 53; ++i) late.samples[i].goal_rad = 0;
  for (ServoSample& one : shifted.samples) {
    one.goal_rad += 0.04;
    one.position_rad += 0.04;
  }
  ServoParams p;
  const Prediction slow = predict(5, p, late), moved = predict(5, p, shifted, 0.04);
  const Prediction direct = predict(5, p, log);
  p.delay = 0.03;
  const Prediction made = predict(5, p, log);
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    EXPECT_NEAR(made.position_rad[i], slow.position_rad[i], 2e-4);
    EXPECT_NEAR(moved.position_rad[i] - 0.04, direct.position_rad[i], 1e-9);
  }
}

// A fit compares predictions with slightly different parameters: they must not depend on the step.
TEST(Pendulum, HardlyDependsOnTheStep) {
  const ServoLog log = log_of(truth::swing(3, truth::Motion::two_sines, 1, 1));
  ServoParams p;
  p.kt = 1.6;
  p.slew = 5;
  p.delay = 0.0234;
  p.lag = 0.007;
  p.error_bias = 1e-3;
  const Prediction fine = predict(5, p, log, 0, 2.5e-4), usual = predict(5, p, log);
  double sum = 0;
  for (std::size_t i = 0; i < log.samples.size(); ++i)
    sum += std::abs(fine.position_rad[i] - usual.position_rad[i]);
  EXPECT_LT(sum / static_cast<double>(log.samples.size()), 3e-4);
}

}  // namespace
}  // namespace kaz::hil
