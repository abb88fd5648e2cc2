// Friction models and control law, checked by closed forms.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo_model/servo_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace kaz::servo_model {
namespace {

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

TEST(FrictionModels, BrakeMoreWithoutTorque) {
  ServoParams p;
  p.coasting = 0.08;
  for (int model = 1; model <= 6; ++model)
    EXPECT_NEAR(friction_limit(model, p, 0.5, 0, 0.3, false),
                friction_limit(model, p, 0.5, 0, 0.3, true) + 0.08, 1e-12);
}

TEST(ServoParameters, HaveUniqueNamesAndDefaultsWithinTheirBounds) {
  for (int model = 1; model <= 6; ++model) {
    std::set<std::string_view> names;
    for (const ServoParamInfo& one : servo_params(model)) {
      EXPECT_TRUE(names.insert(one.name).second) << one.name;
      const double value = ServoParams().*one.at;
      EXPECT_TRUE(value >= one.low && value <= one.high) << one.name;
    }
    for (const char* name : {"delay", "slew", "lag", "error_bias", "coasting"})
      EXPECT_TRUE(names.contains(name)) << name;
  }
}

// Current of a shaft at rest: volts * duty / resistance.
double duty_of(ServoDrive& drive, const ServoCommand& command, double angle, double dt,
               const ServoParams& p) {
  return drive.advance(command, angle, 0, dt) * p.resistance / command.volts;
}

TEST(ServoDrives, MoveTheSetpointWithTheSlewLimit) {
  ServoParams p;
  p.slew = 5;
  ServoDrive drive(p, 0);
  const ServoCommand command{1, 12, 0.1, 1, true};
  for (int i = 0; i < 10; ++i) drive.advance(command, 0, 0, 0.01);
  EXPECT_NEAR(drive.setpoint_rad(), 0.5, 1e-12);
  for (int i = 0; i < 20; ++i) drive.advance(command, 0, 0, 0.01);
  EXPECT_NEAR(drive.setpoint_rad(), 1, 1e-12);
  // Without torque, the setpoint is the angle: the servo does not jump when the torque returns.
  drive.advance({1, 12, 0.1, 1, false}, 0.3, 0, 0.01);
  EXPECT_NEAR(drive.setpoint_rad(), 0.3, 1e-12);
}

// An oscilloscope at an STS3215 showed a duty per error and unit of P of 0.1649, and 0.2577 at 3.07 mrad.
TEST(ServoDrives, FollowTheMeasuredDuty) {
  ServoParams p;
  p.error_bias = 1.73e-3;
  const ServoCommand command{0.003068, 12, 0.1649, 1, true};
  ServoDrive drive(p, command.goal_rad);
  EXPECT_NEAR(duty_of(drive, command, 0, 0.01, p) / 0.003068, 0.2577, 0.002);
  ServoCommand large = command;
  large.goal_rad = 0.1534;
  ServoDrive other(p, large.goal_rad);
  EXPECT_NEAR(duty_of(other, large, 0, 0.01, p) / 0.1534, 0.1668, 0.002);
}

TEST(ServoDrives, LagBehindTheTargetDuty) {
  ServoParams p;
  p.lag = 0.02;
  const ServoCommand command{0.5, 12, 1, 1, true};
  ServoDrive drive(p, 0.5);
  double duty = 0;
  for (int i = 0; i < 200; ++i) duty = duty_of(drive, command, 0, 1e-4, p);
  EXPECT_NEAR(duty, 0.5 * (1 - std::exp(-1)), 1e-3) << "after one time constant";
  // The mean of one large step is the same as that of many small ones.
  ServoDrive coarse(p, 0.5), fine(p, 0.5);
  double mean = 0;
  for (int i = 0; i < 100; ++i) mean += 0.01 * duty_of(fine, command, 0, 1e-4, p);
  EXPECT_NEAR(duty_of(coarse, command, 0, 0.01, p), mean, 1e-9);
}

TEST(ServoDrives, LimitTheDuty) {
  const ServoParams p;
  const ServoCommand command{3, 12, 10, 0.97, true};
  ServoDrive drive(p, 3);
  EXPECT_NEAR(duty_of(drive, command, 0, 0.01, p), 0.97, 1e-12);
}

TEST(ServoDrives, LimitTheCurrent) {
  ServoParams p;
  p.most_current = 1.5;
  const ServoCommand command{3, 12, 10, 1, true};
  ServoDrive drive(p, 3);
  EXPECT_EQ(drive.advance(command, 0, 0, 0.01), 1.5) << "without the limit, 12 V / 3 ohm";
  EXPECT_EQ(drive.advance(command, 6, 0, 0.01), -1.5);
}

TEST(Friction, StopsTheShaftButDoesNotReverseIt) {
  EXPECT_EQ(speed_after(0.1, 0.02, 5, 0.01, 0.01), 0);
  EXPECT_NEAR(speed_after(1, 0.5, 0.2, 0.1, 0.01), 1.03, 1e-12);
  EXPECT_NEAR(speed_after(-1, 0.5, 0.2, 0.1, 0.01), -0.93, 1e-12);
}

}  // namespace
}  // namespace kaz::servo_model
