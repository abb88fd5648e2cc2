// Winding and case against the closed form, and what heat does to the motor.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <Eigen/LU>

#include "sim/body/motor/motor_testing.h"

namespace kaz::sim {
namespace {

// Two bodies in series, constant power P into the first: x' = M x + (P / C_w, 0), from cold
//   x(t) = x_end - sum of e_i exp(lambda_i t), with the eigenvectors of M:
//   lambda = tr / 2 -+ sqrt((tr / 2)^2 - det), e = (M_01, lambda - M_00).
struct TwoBodies {
  TwoBodies(const MotorParams& f, double watts) {
    const double a = 1 / (f.winding_heat_capacity * f.winding_to_case);
    const double b = 1 / (f.case_heat_capacity * f.winding_to_case);
    const double c = 1 / (f.case_heat_capacity * f.case_to_air);
    Eigen::Matrix2d rates;
    rates << -a, a, b, -b - c;
    const double half = rates.trace() / 2, root = std::sqrt(half * half - rates.determinant());
    lambda = {half - root, half + root};
    vectors << rates(0, 1), rates(0, 1), lambda[0] - rates(0, 0), lambda[1] - rates(0, 0);
    end = {watts * (f.winding_to_case + f.case_to_air), watts * f.case_to_air};
    parts = vectors.inverse() * end;
  }
  Eigen::Vector2d at(double t) const {
    return end - vectors * ((lambda * t).array().exp() * parts.array()).matrix();
  }
  Eigen::Matrix2d vectors;
  Eigen::Vector2d lambda, end, parts;
};

TEST(WindingHeat, FollowsTheClosedForm) {
  MotorParams params = test::motor_params();
  const double watts = 3.6;
  const TwoBodies truth(params, watts);
  WindingHeat heat(std::make_shared<const MotorParams>(params));
  double t = 0;
  for (const double until : {1.0, 30.0, 120.0, 600.0, 3000.0}) {
    for (; t < until - 5e-4; t += 1e-3) heat.take(watts, 0, 1e-3);
    const Eigen::Vector2d rise = truth.at(t);
    // Euler's step errs by its share of the time constant, 1e-5.
    EXPECT_NEAR(heat.winding_celsius() - 25, rise[0], 1e-4 * rise[0] + 1e-4) << t;
    EXPECT_NEAR(heat.case_celsius() - 25, rise[1], 1e-4 * rise[1] + 1e-4) << t;
  }
  EXPECT_NEAR(heat.winding_celsius() - 25, 3.6 * 38, 0.5) << "nearly at its end";
}

TEST(WindingHeat, MakesTheMotorWeakerNotItsSpeedWithoutFriction) {
  MotorParams params = test::motor_params();
  params.friction_nm = 0;
  params.winding_heat_capacity = 1e9;  // as hot as it is put
  params.case_heat_capacity = 1e9;
  test::MotorBench cold(params), hot(params);
  JointMotor::State state = hot.motor.state();
  state.winding_celsius = 25 + 80;
  state.case_celsius = 60;
  hot.motor.set_state(state);
  EXPECT_NEAR(hot.motor.resistance_ohm() / cold.motor.resistance_ohm(), 1 + 0.00393 * 80, 1e-9);
  cold.run(0.3, 1, true, 10, 0);
  hot.run(0.3, 1, true, 10, 0);
  EXPECT_NEAR(cold.speed, hot.speed, 1e-4) << "no-load speed is V / K, whatever the resistance";
  cold.run(0.5, 1, true, 10, -1);
  hot.run(0.5, 1, true, 10, -1);
  const double line = (params.stall_slope_nm_per_v * 10 - 1.3144) / params.back_emf_nms_per_rad;
  EXPECT_NEAR(hot.speed, line, 0.001) << "1 Nm costs 31.44 % more speed";
  EXPECT_GT(cold.speed, hot.speed + 1);
}

TEST(WindingHeat, IsOffWhereTheFileSaysNothing) {
  test::MotorBench bench(test::motor_params().ideal());
  bench.run(5, 1, true, 10, -3);
  EXPECT_EQ(bench.motor.winding_celsius(), 25);
  EXPECT_NEAR(bench.motor.resistance_ohm(), 3.3696, 1e-3);
}

// Warmed by I^2 R and by nothing else: what went in is in the bodies or in the air.
TEST(WindingHeat, KeepsItsBooks) {
  const MotorParams f = test::motor_params();
  test::MotorBench bench(f);
  double in = 0, out = 0;
  for (int i = 0; i < 60000; ++i) {
    bench.step(i % 2000 < 1000 ? 0.4 : -0.7, true, 10, 0);
    out += 1e-3 * (bench.motor.case_celsius() - 25) / f.case_to_air;
    in += 1e-3 * (bench.motor.copper_watts() + std::max(0.0, bench.motor.friction_watts()));
  }
  const double kept = f.winding_heat_capacity * (bench.motor.winding_celsius() - 25) +
                      f.case_heat_capacity * (bench.motor.case_celsius() - 25);
  EXPECT_GT(in, 10);
  // `out` is summed with the temperature after each step, the motor uses the one before: 1e-5.
  EXPECT_NEAR(kept + out, in, 1e-4 * in);
}

}  // namespace
}  // namespace kaz::sim
