// A gear motor on a hinge, as one implicit row of the constraint solver.
// SPDX-License-Identifier: Apache-2.0
//
// A row with a velocity goal and a softness obeys  w_new + softness * torque = velocity. With
//   A = stall_slope V duty,  K = back_emf + J/h,  J the rotor's inertia, h the step,
// a turning motor delivers  torque = A -+ friction - back_emf w_new - J (w_new - w_old)/h  exactly,
// if
//   velocity = (A -+ friction + J/h w_old) / K,  softness = 1 / K.
// It is implicit in back-EMF and rotor inertia: an explicit torque is unstable on links as light as
// these. Static friction is a second regime: the shaft is held until the torque that friction would
// have to give in the last step exceeds the breakaway torque.
//
// A slipping gear is a clutch that passes no more than its torque; the motor in front of it is taken to
// turn as the joint does. A jammed gear holds the joint where it is.
//
// Not modelled yet: backlash of the gear (0.4 degrees), heating.
#pragma once

#include "sim/body/motor_file.h"
#include "sim/body/world.h"

namespace kaz::sim {

class JointMotor {
 public:
  JointMotor(const MotorFigures& figures, double step_s) : figures_(figures), step_s_(step_s) {}

  struct Row {
    double velocity = 0;  // rad/s
    double softness = 0;  // rad/s per Nm
    double most = 0;      // Nm, that it gives at most
  };

  // The row for the coming step, for the joint as it moves now (rad, rad/s). Duty beyond -1..1 is
  // cut, NaN is taken as 0.
  Row prepare(const MotorDrive& drive, double supply_volts, double angle, double velocity);
  // After the step: its velocity, and the torque that the row gave. Chooses the regime of the next
  // step.
  void finish(double velocity, double torque);

  // A, drawn from the supply in the last step at the velocity that `finish` was given (mean over
  // the PWM period; negative while braking feeds back). 0 while the bridge is open.
  double supply_current() const { return current_; }
  // A, in the motor itself: the same over the duty, brushes' sign included.
  double motor_current() const { return motor_current_; }

  // All that it remembers (archive.h).
  template <class A>
  void transfer(A& a) {
    a(regime_, stopped_, held_angle_, duty_, volts_, drive_torque_, powered_, jammed_, slipping_,
      current_);
  }

 private:
  enum class Regime { held, forward, backward };

  void stop();

  MotorFigures figures_;
  double step_s_;
  Regime regime_ = Regime::held;
  bool stopped_ = true;  // held, but `held_angle_` is still to be taken
  double held_angle_ = 0;
  double duty_ = 0, volts_ = 0;
  double drive_torque_ = 0;  // A above
  bool powered_ = false;
  bool jammed_ = false, slipping_ = false;
  double current_ = 0, motor_current_ = 0;
};

}  // namespace kaz::sim
