// Friction models by closed forms, and fits by servos that are richer than the models.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "hil/servo/truth_log_testing.h"

namespace kaz::hil {
namespace {

using truth::Motion;

ServoLog pendulum(double seconds, double step = 0.01) {
  ServoLog log;
  log.mass_kg = 0.4;
  log.length_m = 0.15;
  log.gain_per_rad = 4;
  for (int i = 0; i * step <= seconds; ++i) log.samples.push_back({i * step, 0, 0, 12, 0, true});
  return log;
}

TEST(FrictionModels, TakeWhatThePaperSays) {
  ServoParams p;
  p.base = 0.1;
  p.viscous = 0.2;
  p.stribeck = 0.3;
  p.stribeck_speed = 2;
  p.stribeck_power = 1.5;
  p.load = 0.15;
  p.load_stribeck = 0.25;
  p.motor = 0.2;
  p.external = 0.1;
  p.motor_stribeck = 0.05;
  p.external_stribeck = 0.35;
  p.motor_quad = 0.4;
  p.external_quad = 0.5;
  const double s = std::exp(-std::pow(0.5, 1.5)), w = -1, m = 0.8, e = -0.6;
  const double m1 = 0.1 + 0.2;
  EXPECT_NEAR(friction_limit(1, p, w, m, e), m1, 1e-12);
  EXPECT_NEAR(friction_limit(2, p, w, m, e), m1 + s * 0.3, 1e-12);
  EXPECT_NEAR(friction_limit(3, p, w, m, e), m1 + 0.15 * 1.4, 1e-12);
  EXPECT_NEAR(friction_limit(4, p, w, m, e), m1 + 0.15 * 1.4 + s * (0.3 + 0.25 * 1.4), 1e-12);
  const double load = std::abs(0.2 * m - 0.1 * e), slow = std::abs(0.05 * m - 0.35 * e);
  EXPECT_NEAR(friction_limit(5, p, w, m, e), m1 + load + s * (0.3 + slow), 1e-12);
  EXPECT_NEAR(friction_limit(6, p, w, m, e), m1 + load + s * (0.3 + slow + 0.5 * e * e), 1e-12);
  const double weak = std::abs(0.2 * 0.5 - 0.1 * e), weak_slow = std::abs(0.05 * 0.5 - 0.35 * e);
  EXPECT_NEAR(friction_limit(6, p, w, 0.5, e), m1 + weak + s * (0.3 + weak_slow + 0.4 * 0.25),
              1e-12);
  EXPECT_NEAR(friction_limit(6, p, w, m, 0.6), friction_limit(5, p, w, m, 0.6), 1e-12)
      << "they push together";
}

// Without friction and motor a small swing has the period 2 pi sqrt(J / (m g l)).
TEST(Pendulum, SwingsWithItsPeriod) {
  ServoLog log = pendulum(4);
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
  ServoLog log = pendulum(6);
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

// ./tools/dev study servo-table does this for twenty, with every model.
TEST(ServoFits, PredictWhatTheyHaveNotSeenBetterWithLoad) {
  std::vector<ServoLog> logs, held_out;
  for (const Motion motion : {Motion::two_sines, Motion::lift_and_drop}) {
    logs.push_back(log_of(truth::swing(2, motion, 1, 1)));
    logs.push_back(log_of(truth::swing(2, motion, 0.5, 0.25)));
    held_out.push_back(log_of(truth::swing(2, motion, 1, 0.5)));
  }
  ServoFitOptions options;
  options.models = {1, 3, 5};
  const auto fits = fit_servo(logs, held_out, options);
  ASSERT_TRUE(fits) << fits.error().message;
  ASSERT_EQ(fits->size(), 3u);
  EXPECT_LT((*fits)[2].held_out.position_rad, 0.67 * (*fits)[0].held_out.position_rad);
  EXPECT_LT((*fits)[2].held_out.current_share, 0.15);
  std::set<std::string_view> open;
  for (const FittedServoParam& one : (*fits)[2].fitted) {
    if (!one.determined) open.insert(one.of->name);
  }
  EXPECT_FALSE(open.contains("kt"));
  EXPECT_FALSE(open.contains("resistance"));
  EXPECT_TRUE(open.contains("stribeck_power")) << "no servo of the truth has such a power";
}

// A log in which nothing moves says nothing of a rotor or of friction that slides.
TEST(ServoFits, SayWhatTheLogsDoNotDetermine) {
  ServoLog still = pendulum(3);
  still.has_current = true;
  for (ServoSample& one : still.samples) one.goal_rad = one.position_rad = 0.02;
  ServoFitOptions options;
  options.models = {1};
  const auto fits = fit_servo({still}, {}, options);
  ASSERT_TRUE(fits) << fits.error().message;
  for (const FittedServoParam& one : fits->front().fitted) {
    if (one.of->name == "armature" || one.of->name == "viscous") {
      EXPECT_FALSE(one.determined) << one.of->name;
    }
  }
  EXPECT_EQ(fits->front().held_out.position_rad, 0);
}

TEST(ServoFits, AreRefusedWithAReason) {
  EXPECT_FALSE(fit_servo({}, {}));
  // It rises by itself while the motor is off.
  ServoLog wrong = pendulum(3);
  for (ServoSample& one : wrong.samples) {
    one.torque_on = false;
    one.position_rad = 20 * one.time_s;
  }
  ServoFitOptions options;
  options.models = {1};
  const auto fits = fit_servo({wrong}, {}, options);
  ASSERT_FALSE(fits);
  EXPECT_NE(fits.error().message.find("no motor model fits these logs"), std::string::npos);
  options.stopped = [] { return true; };
  EXPECT_EQ(fit_servo({pendulum(2)}, {}, options).error().fault, Fault::interrupted);
}

}  // namespace
}  // namespace kaz::hil
