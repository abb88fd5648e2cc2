// A gear motor on a hinge, as one implicit row of the constraint solver.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/motor/joint_motor.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {
namespace {

// A held shaft yields this much, rad/s per Nm, and comes back by this share of its error each step:
// what an iterative solver leaves undone must not add up to creep.
constexpr double kHeldSoftness = 1e-4;
constexpr double kHeldCorrection = 0.1;
constexpr double kMaxTorque = 1e3;   // Nm; the row's softness is what limits it
constexpr double kMaxWindUp = 1e-3;  // rad that a joint may be behind a held flank

}  // namespace

JointMotor::JointMotor(const MotorParams& params, double step_s)
    : params_(params), step_s_(step_s), heat_(params) {}

JointMotor::State JointMotor::state() const {
  State state = state_;
  state.winding_celsius = heat_.winding_celsius();
  state.case_celsius = heat_.case_celsius();
  return state;
}

void JointMotor::set_state(const State& state) {
  state_ = state;
  heat_.set(state.winding_celsius, state.case_celsius);
}

double JointMotor::resistance_ohm() const {
  return params_.resistance_ohm() * heat_.resistance_ratio();
}

void JointMotor::take_drive(const MotorDrive& drive, double supply_volts) {
  powered_ = drive.powered;
  state_.duty = powered_ && std::isfinite(drive.duty) ? std::clamp(drive.duty, -1.0, 1.0) : 0.0;
  volts_ = std::clamp(supply_volts, 0.0, params_.max_supply_v);
  const double ratio = heat_.resistance_ratio();
  drive_torque_ = params_.stall_slope_nm_per_v / ratio * volts_ * state_.duty;
  stiffness_ = (powered_ ? params_.back_emf_nms_per_rad / ratio : 0.0) +
               params_.rotor_inertia_kgm2 / step_s_;
  jammed_ = drive.jammed;
  max_ = jammed_ ? kMaxTorque : std::clamp(drive.slip_nm, 0.0, kMaxTorque);
  slipping_ = max_ < kMaxTorque;
  tight_ = jammed_ || slipping_ || params_.backlash_rad == 0;
  // Without friction nothing ever holds the rotor, and both directions are the same.
  frictionless_ = params_.friction_nm == 0 && !jammed_;
  if (frictionless_) state_.regime = Regime::forward;
}

// A rotor that has stopped against something goes on pressing with what sliding friction leaves.
void JointMotor::stop() {
  if (state_.regime != Regime::held) {
    const double friction =
        state_.regime == Regime::forward ? params_.friction_nm : -params_.friction_nm;
    const double press = drive_torque_ - friction;
    state_.press = press * state_.torque > 0 ? press : 0;
    state_.torque = state_.torque_before = state_.press;
  }
  state_.regime = Regime::held;
  state_.rotor_speed = 0;
  state_.stopped = true;
}

// A joint that comes through the gap faster than friction can stop the rotor in one step sets it in
// motion; its speed is then more than the f h/J that friction for the wrong side could give it.
void JointMotor::be_struck(double angle, double velocity) {
  const double way =
      0.5 * params_.backlash_rad + std::copysign(1.0, velocity) * (state_.rotor_angle - angle);
  const double stops =
      params_.friction_nm * params_.stiction_ratio * step_s_ / params_.rotor_inertia_kgm2;
  if (std::abs(velocity) * step_s_ <= way || std::abs(velocity) <= stops) return;
  state_.regime = velocity > 0 ? Regime::forward : Regime::backward;
  state_.stopped = false;
}

// Standing still, the motor gives what it is driven with, and friction the rest. The torque of one step
// alone may be a blow, which is over.
void JointMotor::break_loose() {
  const double max = params_.friction_nm * params_.stiction_ratio;
  const double now = drive_torque_ - state_.torque, before = drive_torque_ - state_.torque_before;
  if (std::min(now, before) <= max && std::max(now, before) >= -max) return;
  state_.regime = now > 0 ? Regime::forward : Regime::backward;
  state_.stopped = false;
}

JointMotor::Row JointMotor::prepare(const MotorDrive& drive, double supply_volts, double angle,
                                    double velocity) {
  take_drive(drive, supply_volts);
  if (tight_) {
    state_.rotor_speed = velocity;
    if (state_.regime != Regime::held) state_.rotor_angle = angle;
  }
  if (jammed_ && state_.regime != Regime::held) stop();
  const bool was_moving = state_.regime != Regime::held;
  if (state_.regime == Regime::held && !jammed_) break_loose();
  if (state_.regime == Regime::held && !tight_) be_struck(angle, velocity);
  if (state_.regime != Regime::held) {
    const double friction =
        state_.regime == Regime::forward ? params_.friction_nm : -params_.friction_nm;
    free_speed_ =
        (drive_torque_ - friction + params_.rotor_inertia_kgm2 / step_s_ * state_.rotor_speed) /
        stiffness_;
  }
  if (was_moving && !tight_ && !frictionless_ && will_stop()) stop();
  return tight_ ? tight_row(angle) : flank_row(angle, velocity);
}

// Whether friction ends the motion in the coming step, if the joint goes on resisting or driving as it
// does. Friction for a direction that is left within the step would push.
bool JointMotor::will_stop() const {
  const double a = state_.torque, b = state_.torque_before;
  const double load = a * b <= 0 ? 0 : std::copysign(std::min(std::abs(a), std::abs(b)), a);
  const double next = free_speed_ - load / stiffness_;
  return state_.regime == Regime::forward ? next <= 0 : next >= 0;
}

// A held rotor gives way as soon as this would be more than friction bears; a jammed gear never does.
double JointMotor::pressing(const Row& row) const {
  const double torque = std::clamp(row.velocity / row.softness, row.min, row.max);
  if (state_.regime != Regime::held || jammed_) return torque;
  const double bears = params_.friction_nm * params_.stiction_ratio;
  return std::clamp(torque, drive_torque_ - bears, drive_torque_ + bears);
}

// Rotor and joint turn as one.
JointMotor::Row JointMotor::tight_row(double angle) {
  if (state_.regime != Regime::held) return {free_speed_, 1.0 / stiffness_, max_, -max_};
  const double wound = step_s_ * kHeldSoftness / kHeldCorrection;  // rad per Nm held
  // What has slipped does not come back.
  if (state_.stopped || slipping_) {
    state_.rotor_angle = angle + (slipping_ ? 0 : wound * state_.press);
  }
  state_.stopped = false;
  return {kHeldCorrection * (state_.rotor_angle - angle) / step_s_, kHeldSoftness, max_, -max_};
}

JointMotor::Row JointMotor::flank_row(double angle, double velocity) {
  const double half = 0.5 * params_.backlash_rad;
  const double wound = step_s_ * kHeldSoftness / kHeldCorrection;
  const bool held = state_.regime == Regime::held;
  if (state_.stopped && state_.press != 0) {
    state_.rotor_angle = angle + std::copysign(half, state_.press) + wound * state_.press;
  }
  state_.stopped = false;
  const double reach = held ? half + kMaxWindUp : half;
  const double ahead = std::clamp(state_.rotor_angle - angle, -reach, reach);
  state_.rotor_angle = angle + ahead;

  const double rotor = held ? 0 : free_speed_;
  const double side = ahead + step_s_ * (rotor - velocity) >= 0 ? 1.0 : -1.0;
  const double min = side > 0 ? 0 : -kMaxTorque, max = side > 0 ? kMaxTorque : 0;
  const double way = (half - side * ahead) / step_s_;
  if (held) {
    return {-side * (way < 0 ? kHeldCorrection * way : way), kHeldSoftness, max, min};
  }
  // Friction stops a rotor, it does not turn it back.
  if (frictionless_) return {free_speed_ - side * way, 1.0 / stiffness_, max, min};
  if (state_.regime == Regime::forward && side > 0) free_speed_ = std::max(free_speed_, 0.0);
  if (state_.regime == Regime::backward && side < 0) free_speed_ = std::min(free_speed_, 0.0);
  return {free_speed_ - side * way, 1.0 / stiffness_, max, min};
}

void JointMotor::turn_rotor(double velocity, double torque) {
  if (state_.regime == Regime::held) {
    state_.rotor_speed = 0;
    state_.friction_watts = 0;
    return;
  }
  const double before = state_.rotor_speed;
  double speed = tight_ ? velocity : free_speed_ - torque / stiffness_;
  const bool forward = state_.regime == Regime::forward;
  const bool turned = !frictionless_ && (forward ? speed <= 0 : speed >= 0);
  if (turned && !tight_ && torque == 0) speed = 0;
  // What the motor line and the rotor leave is what friction took.
  const double friction = tight_ || !turned ? (forward ? params_.friction_nm : -params_.friction_nm)
                                            : drive_torque_ - torque - stiffness_ * speed +
                                                  params_.rotor_inertia_kgm2 / step_s_ * before;
  state_.friction_watts = friction * speed;
  state_.rotor_speed = speed;
  state_.rotor_angle += step_s_ * speed;
  if (turned) stop();
}

void JointMotor::finish(double velocity, double torque) {
  state_.torque_before = state_.torque;
  state_.torque = torque;
  turn_rotor(velocity, torque);
  const double speed = tight_ ? velocity : state_.rotor_speed;
  const double resistance = resistance_ohm();
  state_.current =
      powered_ ? (volts_ * state_.duty - params_.torque_constant() * speed) / resistance : 0;
  state_.copper_watts = state_.current * state_.current * resistance;
  heat_.take(state_.copper_watts, std::max(0.0, state_.friction_watts), step_s_);
}

}  // namespace kaz::sim
