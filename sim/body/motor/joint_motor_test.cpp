// The motor row against the equations of a DC motor, cold and without backlash.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/motor/joint_motor.h"

#include <cmath>

#include "sim/body/motor/motor_testing.h"

namespace kaz::sim {
namespace {

// Design section 4: stall torque 0.2288 V - 0.128 Nm; 5.5 rad/s free at 4.8 V.
constexpr double kSlope = 0.2288, kFriction = 0.128, kBackEmf = 0.1764, kRotor = 5e-4;

MotorParams params() {
  return {.name = "",
          .stall_slope_nm_per_v = kSlope,
          .friction_nm = kFriction,
          .back_emf_nms_per_rad = kBackEmf,
          .stiction_ratio = 1.3,
          .rotor_inertia_kgm2 = kRotor,
          .max_supply_v = 12};
}

struct Bench : test::MotorBench {
  explicit Bench(double step = 1e-3) : MotorBench(params(), 1e-4, step) {}
};

TEST(JointMotor, TurnsAtTheSpeedOfTheMotorLine) {
  // w = (slope V - friction - load) / back_emf
  for (const auto& [volts, load] : {std::pair{10.0, 0.0}, {10.0, 1.08}, {4.8, 0.0}, {4.8, 0.5}}) {
    Bench bench;
    bench.run(0.2, 1.0, true, volts, -load);
    EXPECT_NEAR(bench.speed, (kSlope * volts - kFriction - load) / kBackEmf, 1e-6)
        << volts << " V, " << load << " Nm";
  }
}

TEST(JointMotor, StallsAtTheTorquesThePaperMeasured) {
  for (const auto& [volts, stall] : {std::pair{10.0, 2.16}, {4.8, 0.97}}) {
    Bench bench;
    bench.run(0.2, 1.0, true, volts, 0);  // in motion: at rest stiction would hold more
    bench.run(0.5, 1.0, true, volts, -stall + 0.01);
    EXPECT_GT(bench.speed, 0.01) << "should still lift just under " << stall;
    bench.run(0.5, 1.0, true, volts, -stall - 0.01);
    EXPECT_NEAR(bench.speed, 0, 1e-3) << "should not lift just over " << stall;
  }
}

TEST(JointMotor, NeedsMoreTorqueToStartThanToKeepTurning) {
  const double between = 0.5 * (1.0 + 1.3) * kFriction;  // above sliding friction, below breakaway
  Bench resting;
  resting.run(0.1, 0, false, 10, between);
  EXPECT_NEAR(resting.speed, 0, 1e-3);
  EXPECT_NEAR(resting.angle, 0, 1e-3);
  Bench turning;
  turning.run(0.02, 0, false, 10, 2 * kFriction);
  turning.run(0.1, 0, false, 10, between);
  EXPECT_GT(turning.speed, 1.0);
}

TEST(JointMotor, BrakesByBackEmfWhilePowered) {
  // J w' = -back_emf w - friction: w = (w0 + f/b) exp(-t b/J) - f/b.
  Bench bench(1e-5);
  bench.run(0.1, 1.0, true, 10, 0);
  const double w0 = bench.speed, t = 0.003, inertia = bench.inertia + kRotor;
  bench.run(t, 0.0, true, 10, 0);
  const double f_over_b = kFriction / kBackEmf;
  EXPECT_NEAR(bench.speed, (w0 + f_over_b) * std::exp(-t * kBackEmf / inertia) - f_over_b,
              0.005 * w0);
}

TEST(JointMotor, IsSlowedByFrictionAloneWithAnOpenBridge) {
  // J w' = -friction.
  Bench bench(1e-5);
  bench.run(0.1, 1.0, true, 10, 0);
  const double w0 = bench.speed, t = 0.01;
  bench.run(t, 1.0, false, 10, 0);
  EXPECT_NEAR(bench.speed, w0 - kFriction / (bench.inertia + kRotor) * t, 0.001 * w0);
  EXPECT_EQ(bench.motor.supply_current(), 0);
  bench.run(0.1, 1.0, false, 10, 0);
  EXPECT_NEAR(bench.speed, 0, 1e-6);
}

TEST(JointMotor, DrawsWhatItDeliversAndHeats) {
  const MotorParams motor = params();
  Bench bench;
  bench.run(0.2, 1.0, true, 10, -1.0);
  // Electrical power = shaft power + friction + I^2 R, all the duty being 1.
  const double current = bench.motor.supply_current();
  const double heat = current * current * motor.resistance_ohm();
  EXPECT_NEAR(10 * current, (1.0 + kFriction) * bench.speed + heat, 1e-6);
  // Against a wall: V / R.
  bench.run(0.5, 1.0, true, 10, -2.3);
  EXPECT_NEAR(bench.motor.supply_current(), 10 / motor.resistance_ohm(), 1e-3);
}

TEST(JointMotor, GetsNoMoreThanTheDriverStands) {
  Bench at_limit, beyond;
  at_limit.run(0.2, 1.0, true, 12, 0);
  beyond.run(0.2, 1.0, true, 20, 0);
  EXPECT_EQ(at_limit.speed, beyond.speed);
}

TEST(JointMotor, TakesNoHarmFromADutyThatIsNoNumber) {
  Bench bench;
  bench.run(0.01, std::nan(""), true, 10, 0);
  EXPECT_EQ(bench.speed, 0);
  bench.run(0.2, 3.0, true, 10, 0);
  EXPECT_NEAR(bench.speed, (2.288 - kFriction) / kBackEmf, 1e-6);
}

// A clutch of 0.5 Nm on a motor that stalls at 2.2 Nm: it carries this much, moving or blocked, and no more.
TEST(JointMotor, ASlippingGearTransmitsItsTorque) {
  for (const double load : {0.45, 0.55}) {
    Bench bench;
    bench.slip_nm = 0.5;
    bench.run(0.5, 1.0, true, 10, -load);
    EXPECT_EQ(bench.speed > 0, load < 0.5) << load;
  }
  Bench blocked;
  blocked.slip_nm = 0.5;
  blocked.inertia = 1e4;  // a wall
  for (int i = 0; i < 200; ++i) {
    blocked.step(1.0, true, 10, 0);
    if (i > 5) {
      ASSERT_NEAR(blocked.torque, 0.5, 1e-3) << i;
    }
  }
  // Below its torque it does not slip: the wall gets what the motor presses.
  blocked.run(0.05, 0.15, true, 10, 0);
  EXPECT_NEAR(blocked.torque, 0.15 * 10 * kSlope - kFriction, 0.02);
}

TEST(JointMotor, ASlippingGearHoldsByFrictionAndDoesNotPush) {
  Bench bench;
  bench.slip_nm = 0.1;  // below the motor's breakaway torque: the rotor stays held
  bench.run(0.1, 0, false, 10, 0.08);
  EXPECT_NEAR(bench.speed, 0, 1e-3);
  bench.run(0.1, 0, false, 10, 0.15);
  EXPECT_NEAR(bench.speed, 0.05 / bench.inertia * 0.1, 0.5) << "0.15 Nm against 0.1 Nm";
  bench.run(1, 0, false, 10, 0);
  EXPECT_NEAR(bench.speed, 0, 1e-6) << "the clutch brakes it, and comes to rest";
}

TEST(JointMotor, IsStableOnTheLightestLink) {
  Bench bench;
  bench.inertia = 1e-6;
  for (int i = 0; i < 1000; ++i) {
    bench.step(i % 2 ? 1.0 : -1.0, true, 10, 0);
    ASSERT_LT(std::abs(bench.speed), 13.0);
  }
}

}  // namespace
}  // namespace kaz::sim
