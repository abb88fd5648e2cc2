// A gear motor that drives a hinge. In each step, the motor is one row of the constraint solver.
// SPDX-License-Identifier: Apache-2.0
//
// All quantities refer to the output shaft, in SI units. The rotor has its own angle and speed u. Between
// rotor and joint is the backlash b; the potentiometer measures the joint's angle. In each step of h seconds,
// the implicit Euler method computes the rotor's new speed u_new:
//
//   u_new = u_free - T / K,  u_free = (A -+ friction + J/h u) / K,  K = B + D + J/h
//
// A is the drive torque in Nm: A = stall_slope V duty / r, at most the joint's effort limit. B is the
// back-EMF constant in Nm s/rad: B = back_emf / r. While the bridge is open, B = 0. D is the joint's damping
// in Nm s/rad. V is the supply voltage. The ratio r is the winding's present resistance divided by the
// winding's resistance at air temperature. J is the rotor's inertia, h is the step size in s, and T is the
// torque on the joint.
//
// At the end of a step the flanks do not overlap. Consider the flank that pushes forward. The gap between
// rotor and flank is d, and d is never negative. The joint's speed after the step is w_new. Two inequalities
// hold: T >= 0 and u_new - w_new <= d/h. A flank transmits torque only if its gap is closed at the end of the
// step. So T = 0 if the gap is open, and u_new - w_new = d/h if the gap is closed. In the solver, this
// row describes the contact between rotor and flank:
//
//   w_new + softness T = velocity,  softness = 1/K,  velocity = u_free - d/h,  0 <= T
//
// The row for the other flank is the mirror image of this row. In the solution, the flank is either free or
// engaged. A flank never pulls. If the rotor hits the flank during a step, the rotor does not bounce back.
// The row computes the torques of back-EMF and rotor inertia from the speed at the end of the step (implicit
// integration). If these torques were computed from the speed at the beginning of the step, the simulation of
// the robot's light links would be unstable. In each step, the row is for one flank only. To choose the
// flank, prepare() computes the positions of rotor and joint after a step without contact. At these
// positions, the chosen flank is nearer to the rotor than the other flank. A step can end with the rotor
// beyond the other flank. In this case, the next prepare() sets the rotor's angle to the position of the
// other flank. This correction changes an angle but no speed, and therefore adds no energy.
//
// Static friction is a separate regime: the rotor is held until the load exceeds the breakaway torque.
//
// A motor with an identified servo (MotorParams::servo) has no backlash. Its friction is a second row, with
// the target speed 0 and a bound from friction_limit() of the last step's motor torque and external torque.
//
// In the model, a slipping gear limits the torque on the joint. The model ignores the backlash of a slipping
// gear, and the difference between the speeds of motor and joint. A jammed gear locks the joint at its angle.
// Currents are means over a PWM period.
#pragma once

#include <memory>

#include "sim/body/description/motor_file.h"
#include "sim/body/motor/motor_drive.h"
#include "sim/body/motor/winding_heat.h"

namespace kaz::sim {

// For each step, call prepare(), solve the constraints with the row that prepare() returned, then call
// finish().
class JointMotor {
 public:
  JointMotor(const MotorParams& params, double step_s);

  // Constraint on the joint: w_new + softness T = velocity, with min <= T <= max.
  struct Row {
    double velocity = 0;  // rad/s
    double softness = 0;  // rad/s per Nm
    double max = 0;       // Nm
    // Unit: Nm. In the row of a flank, one of `min` and `max` is 0, and the other is so large that it never
    // limits the torque. For a gear without backlash, a slipping gear or a jammed gear, min = -max.
    double min = 0;
    // Largest friction torque (Nm) of an identified servo: the bound of a second row, w_new = 0. Other motors
    // have their friction in the first row.
    double friction = 0;
  };
  // Returns the torque (Nm) with which the motor would press on a rigid obstacle in the coming step. The
  // obstacle holds the joint at rest. `row` is the result of prepare().
  double pressing(const Row& row) const;

  // Computes the row for the coming step from the present angle (rad) and velocity (rad/s) of the joint. The
  // duty is clamped to -1..1. A duty that is not finite counts as 0.
  Row prepare(const MotorDrive& drive, double supply_volts, double angle, double velocity);
  // Updates rotor, current and heat after the step. `velocity` is the joint's velocity after the step
  // (rad/s). `torque` is the torque that the solver found for the row, or for both rows (Nm). `external` is
  // the torque (Nm) of gravity, contacts and other joints on the joint in the step; only identified servos
  // use it.
  void finish(double velocity, double torque, double external = 0);

  // Current drawn from the supply in the last step, A. The current is negative if the motor brakes and feeds
  // current back, and 0 if the bridge is open.
  double supply_current() const { return state_.duty * state_.current; }
  // Motor current, A. A positive current drives the joint forward.
  double motor_current() const { return state_.current; }
  double winding_celsius() const { return heat_.winding_celsius(); }
  double case_celsius() const { return heat_.case_celsius(); }
  double resistance_ohm() const;
  double copper_watts() const { return state_.copper_watts; }
  double friction_watts() const { return state_.friction_watts; }
  double rotor_angle() const { return state_.rotor_angle; }  // rad
  double rotor_speed() const { return state_.rotor_speed; }  // rad/s

  // State that is kept from step to step.
  enum class Regime { held, forward, backward };
  friend constexpr Regime last_value(Regime) { return Regime::backward; }
  struct State {
    Regime regime = Regime::held;
    // True: the rotor has just stopped. If the rotor does not move again, the next prepare() sets
    // `rotor_angle` to the angle at which the rotor is held.
    bool stopped = true;
    double rotor_angle = 0, rotor_speed = 0;
    double torque = 0, torque_before = 0;  // torques on the joint in the last two steps, Nm
    // Torque on the joint at the time when the rotor stopped, Nm.
    double press = 0;
    double duty = 0, current = 0;
    double copper_watts = 0, friction_watts = 0;
    double winding_celsius = 0, case_celsius = 0;
    double external = 0;  // external torque in the last step, Nm; only of identified servos
  };
  State state() const;
  void set_state(const State& state);

  // Archives the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    State& s = state_;
    a(s.regime, s.stopped, s.rotor_angle, s.rotor_speed, s.torque, s.torque_before, s.press, s.duty,
      s.current, s.copper_watts, s.friction_watts, heat_);
    if (params_->servo) a(s.external);
  }

 private:
  void take_drive(const MotorDrive& drive, double supply_volts);
  void break_loose();
  bool will_stop() const;
  void be_struck(double angle, double velocity);
  Row servo_row(double velocity);
  Row tight_row(double angle);
  Row flank_row(double angle, double velocity);
  void turn_rotor(double velocity, double torque);
  void stop();

  std::shared_ptr<const MotorParams> params_;  // shared by all copies of this object
  servo_model::ServoParams servo_params_;      // parameters of MotorParams::servo
  double step_s_;
  WindingHeat heat_;
  State state_;
  // Data of the current step, valid from prepare() to finish().
  bool powered_ = false, jammed_ = false, slipping_ = false, tight_ = false;
  bool frictionless_ = false;
  double volts_ = 0, max_ = 0;
  double drive_torque_ = 0, stiffness_ = 0;  // A and K in the formulas above
  double free_speed_ = 0;                    // u_free in the formulas above
};

}  // namespace kaz::sim
