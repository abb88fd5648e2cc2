// The gap between gear and output shaft: how wide, no energy from it, stable under stiff loops.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include "shared/base/angle.hpp"
#include "sim/body/motor/motor_testing.h"

namespace kaz::sim {
namespace {

using test::MotorBench;
constexpr double kGap = 0.4 * kDegree;

// A hand on the lever, to and fro: so light (0.5 mNm) that the joint arrives at a flank at 0.26 rad/s, no
// blow that turns the gear.
TEST(Backlash, IsAsWideAsAHandFindsIt) {
  for (const bool powered : {false, true}) {
    MotorBench bench;
    bench.run(0.5, 0, powered, 10, 0.0005);
    const double there = bench.angle;
    bench.run(0.5, 0, powered, 10, -0.0005);
    EXPECT_NEAR(there - bench.angle, kGap, 1e-6);
    EXPECT_EQ(bench.motor.rotor_speed(), 0);
  }
}

// A drive that turns round: the rotor crosses the gap alone, the joint waits for it.
TEST(Backlash, IsSeenAsTheJointReverses) {
  MotorBench bench(test::motor_params(), 5e-3);
  bench.run(0.3, 0.3, true, 10, 0);
  EXPECT_NEAR(bench.motor.rotor_angle() - bench.angle, kGap / 2, 1e-6);
  bench.run(0.3, 0, true, 10, -0.02);  // laid against that flank again
  bench.speed = 0;
  const double rests = bench.angle, rotor = bench.motor.rotor_angle();
  EXPECT_NEAR(rotor - rests, kGap / 2, 1e-6);
  for (int i = 0; i < 300 && bench.torque > -0.01; ++i) {
    ASSERT_NEAR(bench.angle, rests, 1e-6) << "nothing has touched it";
    bench.step(-0.1, true, 10, 0);
  }
  ASSERT_LT(bench.torque, -0.01);
  const double joint_way = rests - bench.angle;
  EXPECT_GT(joint_way, 0);
  EXPECT_NEAR(rotor - bench.motor.rotor_angle() - joint_way, kGap, 1e-6);
}

TEST(Backlash, LeavesTheJointFreeInside) {
  MotorBench bench(test::motor_params(), 1e-4);
  // From rest in the middle, a small torque: angle = load t^2 / 2 I, until the flank at 3.5 mrad.
  double t = 0;
  while (bench.angle < 0.9 * kGap / 2) {
    bench.step(0, true, 10, 0.001);
    t += 1e-3;
    ASSERT_EQ(bench.torque, 0);
    ASSERT_NEAR(bench.speed, 0.001 / 1e-4 * t, 1e-9);
  }
  bench.run(0.1, 0, true, 10, 0.001);
  EXPECT_NEAR(bench.angle, kGap / 2, 1e-6);
  EXPECT_NEAR(bench.speed, 0, 1e-6);
  EXPECT_NEAR(bench.torque, -0.001, 1e-5);
}

// Turned from outside, bridge open: friction; powered with duty 0: back-EMF besides.
TEST(Backlash, BackDrivingTakesFrictionAndBraking) {
  const MotorParams f = test::motor_params();
  MotorBench open, braked;
  open.run(0.2, 0, false, 10, 0.02);  // laid against the flank: a blow would break it loose
  open.run(0.2, 0, false, 10, 1.2 * f.friction_nm);
  EXPECT_NEAR(open.speed, 0, 1e-6) << "less than the breakaway torque";
  open.run(0.05, 0, false, 10, 1.4 * f.friction_nm);
  EXPECT_GT(open.speed, 1);
  EXPECT_NEAR(open.torque, -f.friction_nm - (1.4 - 1) * f.friction_nm * 5e-4 / 6e-4, 1e-3)
      << "friction, and the rotor that is sped up";
  braked.run(0.5, 0, true, 10, 1.0);
  EXPECT_NEAR(braked.speed, (1.0 - f.friction_nm) / f.back_emf_nms_per_rad, 0.02);
  EXPECT_EQ(braked.motor.supply_current(), 0) << "shorted, not fed back";
}

// A heavy link thrown about between held flanks, and by a rotor that meets it at full speed: kinetic
// energy of both never grows, but for what a held shaft's softness gives back (10 nJ; at the start there
// is 4.5 uJ in the lightest link).
TEST(Backlash, MakesNoEnergyAtTheFlanks) {
  for (const double inertia : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
    const MotorParams f = test::motor_params();
    MotorBench bench(f, inertia);
    bench.speed = 3;
    const auto energy = [&] {
      const double u = bench.motor.rotor_speed();
      return 0.5 * inertia * bench.speed * bench.speed + 0.5 * f.rotor_inertia_kgm2 * u * u;
    };
    double before = energy(), max = before;
    for (int i = 0; i < 2000; ++i) {
      bench.step(0, i % 400 < 200, 10, 0);
      EXPECT_LE(energy(), before + 1e-8) << inertia << " kg m2, step " << i;
      before = energy();
    }
    EXPECT_LT(before, 1e-3 * max) << inertia;
  }
}

// Electrical work = work on the joint + copper + friction + what is still moving + what flanks and the
// implicit step took; and the last is never less than nothing.
TEST(Backlash, BooksOfARunClose) {
  for (const double inertia : {1e-4, 1e-2}) {
    const MotorParams f = test::motor_params();
    MotorBench bench(f, inertia);
    double in = 0, shaft = 0, copper = 0, friction = 0;
    for (int i = 0; i < 20000; ++i) {
      // A slow swing of the drive against a spring.
      bench.step(0.6 * std::sin(2e-3 * i), true, 10, -0.3 * bench.angle);
      in += 1e-3 * 10 * bench.motor.supply_current();
      shaft += 1e-3 * bench.torque * bench.speed;
      copper += 1e-3 * bench.motor.copper_watts();
      friction += 1e-3 * bench.motor.friction_watts();
    }
    const double u = bench.motor.rotor_speed();
    const double lost = in - shaft - copper - friction - 0.5 * f.rotor_inertia_kgm2 * u * u;
    std::printf("%g kg m2: in %.4f J, shaft %.4f, copper %.4f, friction %.4f, flanks %.5f\n",
                inertia, in, shaft, copper, friction, lost);
    EXPECT_GT(in, 1);
    EXPECT_GT(lost, -1e-6 * in);
    EXPECT_LT(lost, 0.01 * in);
  }
}

// The firmware's stiffest loop, KZ_KP_MAX = 20480/256 of full drive per rad, duty in counts of 255,
// the angle as the potentiometer has it: behind the gap, one step old.
class Loop : public testing::TestWithParam<double> {
 protected:
  static double duty(double target, double angle, double rate, double kd, double kp = 80) {
    return std::clamp(std::round(255 * (kp * (target - angle) - kd * rate)) / 255, -1.0, 1.0);
  }
};
INSTANTIATE_TEST_SUITE_P(Inertias, Loop, testing::Values(1e-6, 1e-5, 1e-4, 1e-3, 1e-2));

// No loop of finite rate is quiet there without damping: it may hunt, within what the motor can.
TEST_P(Loop, StiffestGainWithoutDampingStaysBounded) {
  MotorBench bench(test::motor_params(), GetParam());
  double fastest = 0, furthest = 0;
  for (int i = 0; i < 5000; ++i) {
    const double target = i < 1000 ? 0.3 : i < 2500 ? -0.3 : 0;
    bench.step(duty(target, bench.angle, 0, 0), true, 10, 0);
    fastest = std::max({fastest, std::abs(bench.speed), std::abs(bench.motor.rotor_speed())});
    furthest = std::max(furthest, std::abs(bench.angle));
    ASSERT_LE(std::abs(bench.angle - bench.motor.rotor_angle()), kGap / 2 + 1.1e-5 + 0.013);
  }
  EXPECT_LT(fastest, 12.97) << "10 V over the back-EMF constant: no motor is faster";
  EXPECT_LT(furthest, 0.6);
}

// The gains that the robot walks with (20 of full drive per rad, 0.15 s/rad): at rest.
TEST_P(Loop, WalkingGainSettles) {
  MotorBench bench(test::motor_params(), GetParam());
  const auto run = [&](int steps) {
    double min = bench.motor.rotor_angle(), max = min;
    for (int i = 0; i < steps; ++i) {
      bench.step(duty(0.3, bench.angle, bench.speed, 0.15, 20), true, 10, 0);
      min = std::min(min, bench.motor.rotor_angle());
      max = std::max(max, bench.motor.rotor_angle());
    }
    return max - min;
  };
  run(2000);
  // 0.166 Nm of 45.8 Nm/rad, and the gap.
  EXPECT_NEAR(bench.angle, 0.3, 0.166 / 45.8 + kGap);
  // Inside the gap nothing holds the joint; the rotor is at rest. Of the lightest link the rotor takes
  // no notice, which flies ahead of it and sets the loop on again: it trembles within the gap.
  EXPECT_LT(run(1000), GetParam() < 1e-5 ? kGap : 1e-3 * kGap);
}

// Carrying a weight it rests on one flank, as it would without a gap, and does not hum.
TEST_P(Loop, StiffestGainIsQuietUnderLoad) {
  MotorBench bench(test::motor_params(), GetParam());
  double rate = 0, before = 0;
  const auto run = [&](int steps, double& min, double& max) {
    for (int i = 0; i < steps; ++i) {
      rate += ((bench.angle - before) / 1e-3 - rate) / 8;
      before = bench.angle;
      bench.step(duty(0, bench.angle, rate, 0.3), true, 10, -0.5);
      min = std::min(min, bench.angle);
      max = std::max(max, bench.angle);
    }
  };
  double min = 0, max = 0;
  run(2000, min, max);
  min = max = bench.angle;
  run(1000, min, max);
  EXPECT_LT(max - min, 1e-5);
  EXPECT_NEAR(bench.torque, 0.5, 1e-4);
}

}  // namespace
}  // namespace kaz::sim
