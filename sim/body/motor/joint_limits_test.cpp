// Soft limits against everything a host can set: the servo's loop around the motor of the virtual body.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "shared/servo/board_testing.h"
#include "shared/servo/joint_loop.h"
#include "shared/servo/joints.h"
#include "shared/servo/protection.h"
#include "sim/body/motor/joint_motor.h"

namespace kaz::sim {
namespace {

using test::TestBoard;

constexpr double kUnit = 1e-4;  // rad

// One joint: a limb of some inertia on the motor of motor.xml, the rotor's own besides.
class Limb {
 public:
  Limb(TestBoard& board, int joint, double inertia, double volts)
      : board_(board), joint_(joint), inertia_(inertia), volts_(volts), motor_(params(), kStep_s) {
    board.input.analog[KZ_ANALOG_SUPPLY] = static_cast<u16>(volts * 1000 / 15);
    put(state().angle * kUnit);
  }

  void millisecond() {
    board_.tick();
    const double duty = kz_joint_drive(&state()) / 256.0;
    for (int i = 0; i < kSteps; ++i) {
      const auto row = motor_.prepare({duty, board_.drivers_on()}, volts_, angle_, speed_);
      const double torque = std::clamp(
          (row.velocity - speed_) / (row.softness + kStep_s / inertia_), row.min, row.max);
      speed_ += kStep_s / inertia_ * torque;
      angle_ += kStep_s * speed_;
      motor_.finish(speed_, torque);
    }
    put(angle_);
    const double lower = state().lower * kUnit, upper = state().upper * kUnit;
    overshoot_ = std::max({overshoot_, angle_ - upper, lower - angle_});
    fastest_ = std::max(fastest_, std::abs(speed_));
  }
  void run(int ms) {
    for (int i = 0; i < ms; ++i) {
      if (i % 20 == 0) board_.send(KZ_TYPE_heartbeat, ++board_.sequence, {0, 0});
      millisecond();
    }
  }

  kz_joint& state() { return board_.servo.joint[joint_]; }
  double overshoot() const { return overshoot_; }
  double fastest() const { return fastest_; }
  double angle() const { return angle_; }

 private:
  static constexpr int kSteps = 4;
  static constexpr double kStep_s = 1e-3 / kSteps;
  static MotorParams params() {
    return {.name = "",
            .stall_slope_nm_per_v = 0.2288,
            .friction_nm = 0.128,
            .back_emf_nms_per_rad = 0.1764,
            .stiction_ratio = 1.3,
            .rotor_inertia_kgm2 = 5e-4,
            .max_supply_v = 12,
            .backlash_rad = 0.00698};
  }
  void put(double angle) {
    angle_ = angle;
    const double share =
        (angle / kUnit - state().pot_centre) / static_cast<double>(state().pot_scale);
    const double code = std::clamp(512 + 512 * share, 4.0, 1019.0);
    board_.set_pot(joint_, static_cast<u16>(code));
  }

  TestBoard& board_;
  int joint_;
  double inertia_, volts_;
  JointMotor motor_;
  double angle_ = 0, speed_ = 0, overshoot_ = 0, fastest_ = 0;
};

constexpr int kNeckPan = 0, kRHipPitch = 15, kRKnee = 16;
// From a head to a stretched leg about the hip.
constexpr std::array<double, 4> kInertias = {5e-4, 2e-3, 8e-3, 2e-2};

// rad past the limit. Below 10 V the motor has less to brake with, and the heaviest limb goes further.
double margin(double volts) {
  return volts < 10 ? 0.06 : 0.03;
}

// Gains at their bounds, no damping, ramps at their bound, from one limit to the other.
TEST(SoftLimits, HostileGainsDoNotDriveAJointPastThem) {
  for (const int joint : {kNeckPan, kRHipPitch, kRKnee}) {
    for (const double inertia : kInertias) {
      for (const u16 kp : {u16{5120}, u16{KZ_KP_MAX}}) {
        TestBoard board;
        Limb limb(board, joint, inertia, 10);
        board.ticks(10);
        const u32 mask = 1u << joint;
        ASSERT_EQ(board.limits(mask, KZ_RAMP_MAX, static_cast<s16>(limb.state().angle - 7000),
                               static_cast<s16>(limb.state().angle + 7000)),
                  0);
        ASSERT_EQ(board.gains(mask, kp, 0), 0);
        ASSERT_EQ(board.enable(mask), 0);
        for (int i = 0; i < 6; ++i) {
          const s16 target = i % 2 ? limb.state().lower : limb.state().upper;
          board.target(joint, target, 0);
          limb.run(400);
        }
        EXPECT_LT(limb.overshoot(), margin(10))
            << "joint " << joint << ", " << inertia << " kg m2, kp " << kp;
      }
    }
  }
}

// Full raw drive, from where it reaches its highest speed.
TEST(SoftLimits, RawDriveDoesNotDriveAJointPastThem) {
  double worst = 0, fastest = 0;
  for (const int joint : {kNeckPan, kRHipPitch, kRKnee}) {
    for (const double inertia : kInertias) {
      for (const double volts : {5.0, 10.0, 12.0}) {
        for (const s16 duty : {s16{255}, s16{-255}}) {
          TestBoard board;
          Limb limb(board, joint, inertia, volts);
          board.ticks(10);
          board.servo.raw_joint = static_cast<u8>(joint);
          board.servo.raw_duty = duty;
          for (int ms = 0; ms < 1500; ++ms) {
            board.servo.raw_ms = 100;
            limb.run(1);
          }
          EXPECT_LT(limb.overshoot(), margin(volts))
              << "joint " << joint << ", " << inertia << " kg m2, " << volts << " V, duty " << duty;
          const double remaining = duty > 0 ? limb.state().upper * kUnit - limb.angle()
                                            : limb.angle() - limb.state().lower * kUnit;
          EXPECT_LT(remaining, 0.1) << "it does not get there";
          worst = std::max(worst, limb.overshoot());
          fastest = std::max(fastest, limb.fastest());
        }
      }
    }
  }
  std::printf("raw drive: %.4f rad past a limit at most, up to %.1f rad/s\n", worst, fastest);
  EXPECT_GT(fastest, 6);
}

// The head on its pan joint: light, bearing nothing, free in the gap. At the gains of the behaviors (12 of
// full drive per rad, 0.15 s/rad) and at those after a reset the gear comes to rest: what moves is within the
// gap and one step of the potentiometer.
TEST(Neck, RestsInTheBacklashOfItsGear) {
  constexpr double gap = 0.4, step = 190.0 / 1024;  // degrees
  struct Gains {
    u16 kp, kd;
  };
  for (const auto& [kp, kd] :
       {Gains{8 * 256, 614}, Gains{12 * 256, 614}, Gains{KZ_KP_DEFAULT, KZ_KD_DEFAULT}}) {
    for (const double inertia : {3e-5, 1e-4}) {
      TestBoard board;
      Limb limb(board, kNeckPan, inertia, 10);
      board.ticks(10);
      ASSERT_EQ(board.gains(1u << kNeckPan, kp, kd), 0);
      ASSERT_EQ(board.enable(1u << kNeckPan), 0);
      double worst = 0;
      for (int i = 0; i < 20; ++i) {
        board.target(kNeckPan, static_cast<s16>(i * 137 - 1300), 100);
        limb.run(600);
        double min = limb.angle(), max = min;
        for (int ms = 0; ms < 400; ++ms) {
          limb.run(1);
          min = std::min(min, limb.angle());
          max = std::max(max, limb.angle());
        }
        worst = std::max(worst, max - min);
      }
      std::printf("kp %.0f, %g kg m2: moves by %.2f degrees at rest\n", kp / 256.0, inertia,
                  worst * 57.3);
      EXPECT_LT(worst * 57.3, gap + step) << kp / 256.0 << ", " << inertia << " kg m2";
    }
  }
}

}  // namespace
}  // namespace kaz::sim
