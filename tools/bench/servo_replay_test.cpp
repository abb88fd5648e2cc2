// A virtual servo moves a pendulum as the model of the same parameters predicts.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/servo_replay.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/servo/servo_prediction.h"

namespace kaz::tools {
namespace {

// 0.4 kg at 0.12 m. The goal swings with growing speed for 3 s, steps at 3 s, and the torque is off from 4 s
// to 5 s.
hil::ServoLog swing(double gain_per_rad, double volts) {
  hil::ServoLog log;
  log.name = "swing";
  log.mass_kg = 0.4;
  log.length_m = 0.12;
  log.gain_per_rad = gain_per_rad;
  log.most_duty = volts > 10 ? 0.97 : 1;  // STS3215, XL330
  for (int i = 0; i < 600; ++i) {
    const double t = 0.01 * i;
    const double goal = t < 3 ? 0.8 * std::sin(t * t) : t < 3.5 ? -0.6 : 1.2;
    log.samples.push_back({t, goal, 0, volts, 0, t < 4 || t >= 5});
  }
  return log;
}

servo_model::IdentifiedServo servo_of(const std::string& name, int model, double volts) {
  servo_model::IdentifiedServo servo;
  servo.servo = name;
  servo.model = model;
  servo.volts = volts;
  servo_model::ServoParams p;
  p.kt = volts > 10 ? 2.3 : 0.45;
  p.resistance = 4.5;
  p.armature = volts > 10 ? 0.019 : 0.0018;
  p.base = volts > 10 ? 0.05 : 0.01;
  p.viscous = p.base / 3;
  p.stribeck = p.base / 2;
  p.coasting = p.base;
  p.load = p.motor = 0.1;
  p.external = p.load_stribeck = 0.15;
  p.motor_stribeck = p.external_stribeck = 0.05;
  p.motor_quad = p.external_quad = 0.2;
  p.gain_ratio = 1.05;
  p.error_bias = 1e-3;
  p.delay = 0.0216;
  p.slew = 4.95;
  p.lag = 0.0056;
  for (const servo_model::ServoParamInfo& info : servo_model::servo_params(model))
    servo.identified.push_back({&info, p.*info.at});
  return servo;
}

double distance_of(const servo_model::IdentifiedServo& servo, const hil::ServoLog& log,
                   const servo_model::ServoParams& params) {
  const auto replayed = replay_log(servo, log, 0);
  EXPECT_TRUE(replayed) << replayed.error().message;
  if (!replayed) return NAN;
  const hil::Prediction made = hil::predict(servo.model, params, log);
  double sum = 0;
  for (std::size_t i = 0; i < replayed->size(); ++i)
    sum += std::abs((*replayed)[i] - made.position_rad[i]);
  return sum / static_cast<double>(replayed->size());
}

TEST(ServoReplays, FollowThePredictionOfEachFrictionModel) {
  for (int model = 1; model <= 6; ++model) {
    const auto servo = servo_of("sts3215", model, 12);
    EXPECT_LT(distance_of(servo, swing(0.1649 * 16, 12), servo.params()), 2e-3) << "M" << model;
  }
}

TEST(ServoReplays, FollowThePredictionOfADynamixel) {
  const auto servo = servo_of("xl330-m288", 6, 6);
  const double unit = 4096 / (2 * 3.14159265358979) / 256 / 885;
  hil::ServoLog log = swing(400 * unit, 6);
  log.mass_kg = 0.1;
  EXPECT_LT(distance_of(servo, log, servo.params()), 2e-3);
}

// Each of these effects is larger than what a replay may be wrong by.
TEST(ServoReplays, HaveTheDelayTheSlewLimitAndTheFriction) {
  const auto servo = servo_of("sts3215", 6, 12);
  const hil::ServoLog log = swing(0.1649 * 16, 12);
  for (double servo_model::ServoParams::*at :
       {&servo_model::ServoParams::delay, &servo_model::ServoParams::viscous,
        &servo_model::ServoParams::external, &servo_model::ServoParams::coasting}) {
    servo_model::ServoParams without = servo.params();
    without.*at = 0;
    EXPECT_GT(distance_of(servo, log, without), 3e-3);
  }
  servo_model::ServoParams fast = servo.params();
  fast.slew = 100;
  EXPECT_GT(distance_of(servo, log, fast), 3e-3);
}

TEST(ServoReplays, StartWhereTheLogStarts) {
  const auto servo = servo_of("sts3215", 3, 12);
  hil::ServoLog log = swing(0.1649 * 32, 12);
  for (hil::ServoSample& one : log.samples) {
    one.goal_rad += 0.3;
    one.position_rad = 0.3;
  }
  const auto replayed = replay_log(servo, log, 0.25);
  ASSERT_TRUE(replayed) << replayed.error().message;
  EXPECT_NEAR((*replayed)[0], 0.3, 3e-3);
}

TEST(ServoReplays, RejectUnknownModelsAndGains) {
  const hil::ServoLog log = swing(0.1649 * 0.4, 12);
  EXPECT_EQ(replay_log(servo_of("sts1", 1, 12), log, 0).error().message,
            "--replay sts1: unknown model; docs/reference/servo-bus.md lists models");
  const auto replayed = replay_log(servo_of("sts3215", 1, 12), log, 0);
  ASSERT_FALSE(replayed);
  EXPECT_EQ(replayed.error().message,
            "gain_per_rad is 0.065960: no P gain of the sts3215 is within 2 % of it");
}

}  // namespace
}  // namespace kaz::tools
