// A gear motor on a hinge, as one implicit row of the constraint solver.
// SPDX-License-Identifier: Apache-2.0
//
// All quantities at the output shaft, SI. The rotor has its own angle and speed u; the joint, with its
// potentiometer, follows behind the backlash b. With A = stall_slope V duty (Nm), B = back_emf (Nm s/rad, 0
// while the bridge is open), J the rotor's inertia, h the step, T the torque on the joint, an implicit Euler
// step is
//
//   u_new = u_free - T / K,  u_free = (A -+ friction + J/h u) / K,  K = B + J/h
//
// At the end of a step the flanks do not overlap: with a gap d >= 0 to the flank that pushes forward,
// u_new - w_new <= d/h and T >= 0, complementary (one of the two holds as an equation). For the solver this
// is one row
//
//   w_new + softness T = velocity,  softness = 1/K,  velocity = u_free - d/h,  0 <= T
//
// and its mirror image for the other flank. Free and engaged are two solutions of the same row: a flank
// never pulls, and flanks meet without bounce within the step. The row is implicit in back-EMF and rotor
// inertia: explicit torques are unstable on links as light as these. The row is that of the flank to which
// the rotor would be nearer after the step. If the joint passes the other flank, the rotor's angle is reset
// to it: this changes an angle, no speed, and so adds no energy.
//
// Static friction is a separate regime: the rotor is held until the load exceeds the breakaway torque.
//
// A slipping gear is a clutch with a max torque; the motor is assumed to turn with the joint, without
// backlash. A jammed gear locks the joint at its angle.
//
// Current is the mean over a PWM period (docs/reference/robot.md explains why that is enough).
#pragma once

#include <memory>

#include "sim/body/description/motor_file.h"
#include "sim/body/motor/motor_drive.h"
#include "sim/body/motor/winding_heat.h"

namespace kaz::sim {

class JointMotor {
 public:
  JointMotor(const MotorParams& params, double step_s);

  struct Row {
    double velocity = 0;  // rad/s
    double softness = 0;  // rad/s per Nm
    double max = 0;       // Nm
    double min = 0;       // Nm; -max, or one of the two is 0 and the other practically unbounded
  };
  // Torque on a joint that is held at rest by a rigid obstacle in the coming step, Nm.
  double pressing(const Row& row) const;

  // The row for the coming step from the joint's present angle and velocity (rad, rad/s). Duty is clamped
  // to -1..1, NaN is taken as 0.
  Row prepare(const MotorDrive& drive, double supply_volts, double angle, double velocity);
  // After the step: the joint's new velocity and the torque of the row; updates rotor, current and heat.
  void finish(double velocity, double torque);

  // A, drawn from the supply in the last step (mean over the PWM period; negative while braking
  // feeds back). 0 while the bridge is open.
  double supply_current() const { return state_.duty * state_.current; }
  double motor_current() const { return state_.current; }  // A, positive turns positively
  double winding_celsius() const { return heat_.winding_celsius(); }
  double case_celsius() const { return heat_.case_celsius(); }
  double resistance_ohm() const;
  double copper_watts() const { return state_.copper_watts; }
  double friction_watts() const { return state_.friction_watts; }
  double rotor_angle() const { return state_.rotor_angle; }  // rad
  double rotor_speed() const { return state_.rotor_speed; }  // rad/s

  // The state carried from step to step.
  enum class Regime { held, forward, backward };
  friend constexpr Regime last_value(Regime) { return Regime::backward; }
  struct State {
    Regime regime = Regime::held;
    bool stopped = true;  // just stopped: the angle at which it is held is not set yet
    double rotor_angle = 0, rotor_speed = 0;
    double torque = 0, torque_before = 0;  // of the last two steps, Nm
    double press = 0;                      // torque on the joint when it stopped, Nm
    double duty = 0, current = 0;
    double copper_watts = 0, friction_watts = 0;
    double winding_celsius = 0, case_celsius = 0;
  };
  State state() const;
  void set_state(const State& state);

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    State& s = state_;
    a(s.regime, s.stopped, s.rotor_angle, s.rotor_speed, s.torque, s.torque_before, s.press, s.duty,
      s.current, s.copper_watts, s.friction_watts, heat_);
  }

 private:
  void take_drive(const MotorDrive& drive, double supply_volts);
  void break_loose();
  bool will_stop() const;
  void be_struck(double angle, double velocity);
  Row tight_row(double angle);
  Row flank_row(double angle, double velocity);
  void turn_rotor(double velocity, double torque);
  void stop();

  std::shared_ptr<const MotorParams> params_;  // shared by all copies
  double step_s_;
  WindingHeat heat_;
  State state_;
  // Of the current step, from prepare() to finish().
  bool powered_ = false, jammed_ = false, slipping_ = false, tight_ = false;
  bool frictionless_ = false;
  double volts_ = 0, max_ = 0;
  double drive_torque_ = 0, stiffness_ = 0;  // A and K above
  double free_speed_ = 0;                    // u_free above
};

}  // namespace kaz::sim
