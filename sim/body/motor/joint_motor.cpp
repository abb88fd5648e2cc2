// A gear motor on a hinge, as one implicit row of the constraint solver.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/motor/joint_motor.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {
namespace {

// Compliance of a held shaft, rad/s per Nm, and the fraction of its position error that is corrected in
// each step, so that the residual of an iterative solver does not accumulate as creep.
constexpr double kHeldSoftness = 1e-4;
constexpr double kHeldCorrection = 0.1;
constexpr double kMaxTorque = 1e3;   // Nm; no practical bound, the row's softness limits the torque
constexpr double kMaxWindUp = 1e-3;  // rad, max penetration of a joint into a held flank

}  // namespace

JointMotor::JointMotor(const MotorParams& params, double step_s)
    : params_(std::make_shared<const MotorParams>(params)), step_s_(step_s), heat_(params_) {
  if (params.servo) servo_params_ = params.servo->params();
}

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
  return params_->resistance_ohm() * heat_.resistance_ratio();
}

// Motor line at the winding's temperature: the resistance ratio r = R(T) / R(T_air) divides both stall slope
// and back-EMF, A = stall_slope / r V duty, K = back_emf / r + damping + J / h (Nm, Nm s/rad).
void JointMotor::take_drive(const MotorDrive& drive, double supply_volts) {
  powered_ = drive.powered;
  state_.duty = powered_ && std::isfinite(drive.duty) ? std::clamp(drive.duty, -1.0, 1.0) : 0.0;
  volts_ = std::clamp(supply_volts, 0.0, params_->max_supply_v);
  const double ratio = heat_.resistance_ratio();
  drive_torque_ = std::clamp(params_->stall_slope_nm_per_v / ratio * volts_ * state_.duty,
                             -params_->max_drive_nm, params_->max_drive_nm);
  stiffness_ = (powered_ ? params_->back_emf_nms_per_rad / ratio : 0.0) +
               params_->damping_nms_per_rad + params_->rotor_inertia_kgm2 / step_s_;
  jammed_ = drive.jammed;
  max_ = jammed_ ? kMaxTorque : std::clamp(drive.slip_nm, 0.0, kMaxTorque);
  slipping_ = max_ < kMaxTorque;
  tight_ = jammed_ || slipping_ || params_->backlash_rad == 0;
  // Without friction the rotor is never held, and both directions have the same row.
  frictionless_ = params_->friction_nm == 0 && !jammed_;
  if (frictionless_) state_.regime = Regime::forward;
}

// A rotor that has stopped against an obstacle keeps pressing with A minus the sliding friction.
void JointMotor::stop() {
  if (state_.regime != Regime::held) {
    const double friction =
        state_.regime == Regime::forward ? params_->friction_nm : -params_->friction_nm;
    const double press = drive_torque_ - friction;
    state_.press = press * state_.torque > 0 ? press : 0;
    state_.torque = state_.torque_before = state_.press;
  }
  state_.regime = Regime::held;
  state_.rotor_speed = 0;
  state_.stopped = true;
}

// A joint that crosses the gap faster than friction can stop the rotor in one step starts the rotor: its
// speed then exceeds f h/J, the speed that friction of the wrong sign could add.
void JointMotor::be_struck(double angle, double velocity) {
  const double gap =
      0.5 * params_->backlash_rad + std::copysign(1.0, velocity) * (state_.rotor_angle - angle);
  const double stops =
      params_->friction_nm * params_->stiction_ratio * step_s_ / params_->rotor_inertia_kgm2;
  if (std::abs(velocity) * step_s_ <= gap || std::abs(velocity) <= stops) return;
  state_.regime = velocity > 0 ? Regime::forward : Regime::backward;
  state_.stopped = false;
}

// Static friction balances drive and load: |A - T| <= stiction_ratio friction. The rotor breaks loose only
// if two steps in a row exceed this, since the torque of one step may be an impact that is over.
void JointMotor::break_loose() {
  const double max = params_->friction_nm * params_->stiction_ratio;
  const double now = drive_torque_ - state_.torque, before = drive_torque_ - state_.torque_before;
  if (std::min(now, before) <= max && std::max(now, before) >= -max) return;
  state_.regime = now > 0 ? Regime::forward : Regime::backward;
  state_.stopped = false;
}

// The row of an identified servo. Its friction is added to that of the robot's joint.
JointMotor::Row JointMotor::servo_row(double velocity) {
  const double per_speed = params_->rotor_inertia_kgm2 / step_s_;
  const double motor =
      drive_torque_ - (stiffness_ - per_speed - params_->damping_nms_per_rad) * velocity;
  const servo_model::IdentifiedServo& servo = *params_->servo;
  const double friction =
      params_->friction_nm + servo_model::friction_limit(servo.model, servo_params_, velocity,
                                                         motor, state_.external, powered_);
  tight_ = true;
  state_.rotor_speed = velocity;
  free_speed_ = (drive_torque_ + per_speed * velocity) / stiffness_;
  return {free_speed_, 1.0 / stiffness_, max_, -max_,
          jammed_ ? kMaxTorque : std::min(friction, max_)};
}

JointMotor::Row JointMotor::prepare(const MotorDrive& drive, double supply_volts, double angle,
                                    double velocity) {
  take_drive(drive, supply_volts);
  if (params_->servo) return servo_row(velocity);
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
        state_.regime == Regime::forward ? params_->friction_nm : -params_->friction_nm;
    free_speed_ =
        (drive_torque_ - friction + params_->rotor_inertia_kgm2 / step_s_ * state_.rotor_speed) /
        stiffness_;
  }
  if (was_moving && !tight_ && !frictionless_ && will_stop()) stop();
  return tight_ ? tight_row(angle) : flank_row(angle, velocity);
}

// Predicts whether friction stops the rotor in the coming step under the present load, the smaller of the
// last two torques of equal sign: u_free - T / K changes sign. Beyond the stop friction would accelerate.
bool JointMotor::will_stop() const {
  const double a = state_.torque, b = state_.torque_before;
  const double load = a * b <= 0 ? 0 : std::copysign(std::min(std::abs(a), std::abs(b)), a);
  const double next = free_speed_ - load / stiffness_;
  return state_.regime == Regime::forward ? next <= 0 : next >= 0;
}

// A held rotor breaks loose as soon as |A - T| exceeds the breakaway torque; a jammed gear never does.
double JointMotor::pressing(const Row& row) const {
  const double torque = std::clamp(row.velocity / row.softness, row.min, row.max);
  if (state_.regime != Regime::held || jammed_) return torque;
  const double breakaway = params_->friction_nm * params_->stiction_ratio;
  const double held = std::clamp(torque, drive_torque_ - breakaway, drive_torque_ + breakaway);
  return slipping_ ? std::clamp(held, row.min, row.max) : held;
}

// The row without backlash: rotor and joint have the same speed. Moving: w = u_free - T / K. Held: a stiff
// spring to the angle at which the rotor stopped.
JointMotor::Row JointMotor::tight_row(double angle) {
  if (state_.regime != Regime::held) return {free_speed_, 1.0 / stiffness_, max_, -max_};
  const double wound = step_s_ * kHeldSoftness / kHeldCorrection;  // rad per Nm held
  if (state_.stopped) {
    state_.rotor_angle = angle + wound * std::clamp(state_.press, -max_, max_);
  } else if (slipping_) {
    // Once it has slipped the clutch rests at another angle, wound up by its torque.
    state_.rotor_angle =
        angle + std::clamp(state_.rotor_angle - angle, -wound * max_, wound * max_);
  }
  state_.stopped = false;
  return {kHeldCorrection * (state_.rotor_angle - angle) / step_s_, kHeldSoftness, max_, -max_};
}

// The row of the nearer flank (joint_motor.h): velocity = u_free -+ d/h with d = b/2 -+ ahead the gap to it,
// torque of one sign only. `ahead`: rotor minus joint, rad, clamped to the gap.
JointMotor::Row JointMotor::flank_row(double angle, double velocity) {
  const double half = 0.5 * params_->backlash_rad;
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
  const double closing = (half - side * ahead) / step_s_;  // d/h, rad/s
  if (held) {
    return {-side * (closing < 0 ? kHeldCorrection * closing : closing), kHeldSoftness, max, min};
  }
  // Friction stops a rotor but does not reverse it.
  if (frictionless_) return {free_speed_ - side * closing, 1.0 / stiffness_, max, min};
  if (state_.regime == Regime::forward && side > 0) free_speed_ = std::max(free_speed_, 0.0);
  if (state_.regime == Regime::backward && side < 0) free_speed_ = std::min(free_speed_, 0.0);
  return {free_speed_ - side * closing, 1.0 / stiffness_, max, min};
}

// Rotor after the step: u_new = u_free - T / K, at most to rest. Friction power = friction u.
void JointMotor::turn_rotor(double velocity, double torque) {
  if (params_->servo) {
    const double friction = (free_speed_ - velocity) * stiffness_ - torque;
    state_.friction_watts = friction * velocity;
    state_.rotor_speed = velocity;
    state_.rotor_angle += step_s_ * velocity;
    return;
  }
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
  // In the step in which the rotor stops, friction is the remainder of A - T - K u_new + J/h u_old = f.
  const double friction = tight_ || !turned
                              ? (forward ? params_->friction_nm : -params_->friction_nm)
                              : drive_torque_ - torque - stiffness_ * speed +
                                    params_->rotor_inertia_kgm2 / step_s_ * before;
  state_.friction_watts = friction * speed;
  state_.rotor_speed = speed;
  state_.rotor_angle += step_s_ * speed;
  if (turned) stop();
}

// I = (V duty - k_e u) / R(T) in A, copper loss I^2 R(T) in W.
void JointMotor::finish(double velocity, double torque, double external) {
  state_.external = external;
  state_.torque_before = state_.torque;
  state_.torque = torque;
  turn_rotor(velocity, torque);
  const double speed = tight_ ? velocity : state_.rotor_speed;
  const double resistance = resistance_ohm();
  state_.current =
      powered_ ? (volts_ * state_.duty - params_->torque_constant() * speed) / resistance : 0;
  state_.copper_watts = state_.current * state_.current * resistance;
  heat_.take(state_.copper_watts, std::max(0.0, state_.friction_watts), step_s_);
}

}  // namespace kaz::sim
