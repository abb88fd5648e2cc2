// A gear motor on a hinge, as one implicit row of the constraint solver.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/joint_motor.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {
namespace {

// A held shaft yields this much, rad/s per Nm, and comes back by this share of its error each step:
// what an iterative solver leaves undone must not add up to creep.
constexpr double kHeldSoftness = 1e-4;
constexpr double kHeldCorrection = 0.1;
constexpr double kMostTorque = 1e3;  // Nm; the row's softness is what limits it

}  // namespace

JointMotor::Row JointMotor::prepare(const MotorDrive& drive, double supply_volts, double angle,
                                    double velocity) {
  powered_ = drive.powered;
  duty_ = powered_ && std::isfinite(drive.duty) ? std::clamp(drive.duty, -1.0, 1.0) : 0.0;
  volts_ = std::clamp(supply_volts, 0.0, figures_.max_supply_v);
  drive_torque_ = figures_.stall_slope_nm_per_v * volts_ * duty_;
  jammed_ = drive.jammed;
  const double most = jammed_ ? kMostTorque : std::clamp(drive.slip_nm, 0.0, kMostTorque);
  slipping_ = most < kMostTorque;
  if (jammed_ && regime_ != Regime::held) stop();
  if (regime_ == Regime::held) {
    if (stopped_) held_angle_ = angle;
    stopped_ = false;
    return {kHeldCorrection * (held_angle_ - angle) / step_s_, kHeldSoftness, most};
  }
  const double inertia_per_step = figures_.rotor_inertia_kgm2 / step_s_;
  const double slope = (powered_ ? figures_.back_emf_nms_per_rad : 0.0) + inertia_per_step;
  const double friction = regime_ == Regime::forward ? figures_.friction_nm : -figures_.friction_nm;
  return {(drive_torque_ - friction + inertia_per_step * velocity) / slope, 1.0 / slope, most};
}

void JointMotor::stop() {
  regime_ = Regime::held;
  stopped_ = true;
}

void JointMotor::finish(double velocity, double torque) {
  switch (regime_) {
    case Regime::held: {
      // Standing still, the motor assembly gives drive and friction and nothing else.
      const double friction = torque - drive_torque_;
      stopped_ = slipping_;  // what has slipped does not come back
      if (!jammed_ && std::abs(friction) > figures_.friction_nm * figures_.stiction_ratio) {
        regime_ = friction < 0 ? Regime::forward : Regime::backward;
      }
      break;
    }
    case Regime::forward:
      if (velocity <= 0) stop();
      break;
    case Regime::backward:
      if (velocity >= 0) stop();
      break;
  }
  if (!powered_) {
    current_ = motor_current_ = 0;
    return;
  }
  motor_current_ =
      (volts_ * duty_ - figures_.torque_constant() * velocity) / figures_.resistance_ohm();
  current_ = duty_ * motor_current_;
}

}  // namespace kaz::sim
