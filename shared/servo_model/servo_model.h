// Model of a geared bus servo: goal, control law, motor, and friction in six models of increasing detail.
// SPDX-License-Identifier: Apache-2.0
//
// Source of the friction models: Duclusaud, Passault, Padois, Ly, "Extended Friction Models for the Physics
// Simulation of Servo Actuators", ICRA 2025 (arXiv 2410.08650). All quantities are at the output shaft, in SI
// units.
//
// Symbols in the formulas:
//
// - w: speed.
// - m: motor torque.
// - e: external torque, which acts in addition to m.
// - s: exp(-|w / stribeck_speed|^stribeck_power).
//
// The maximum friction torque of each model is:
//
// - M1: viscous |w| + base.
// - M2: M1 + s stribeck.
// - M3: M1 + load |m - e|.
// - M4: M1 + load |m - e| + s (stribeck + load_stribeck |m - e|).
// - M5: M1 + |motor m - external e| + s (stribeck + |motor_stribeck m - external_stribeck e|).
// - M6: M5 + s q if m and e have opposite signs, otherwise M5. If |m| > |e|, q = external_quad e^2; otherwise
//   q = motor_quad m^2.
//
// All models have these effects, which 720 logs of a Feetech STS3215 show:
//
// - A goal acts after `delay`. The setpoint then follows the goal with at most the speed `slew`.
// - The duty is gain (error + b), where b has the error's sign and the size of `error_bias`. For errors
//   below 3 mrad, b is proportional to the error. An oscilloscope at the motor shows the same law.
// - The duty follows this value as a first-order lag. The position register of an STS3215 changes only every
//   8 ms, so the control law sees an old position; the lag stands for this age.
// - The motor current is at most `most_current`.
// - Without torque, friction is higher by `coasting`, because the PWM's ripple shakes the driven gear loose.
#pragma once

#include <span>
#include <string_view>

namespace kaz::servo_model {

struct ServoParams {
  // The motor follows torque = kt I and voltage = R I + kt w. `armature` is the inertia of rotor and gear.
  double kt = 1;                                     // unit N m/A = V s/rad
  double resistance = 3;                             // ohm
  double armature = 0.005;                           // kg m2
  double base = 0.03, viscous = 0.02, stribeck = 0;  // units N m, N m s/rad, N m
  double stribeck_speed = 1, stribeck_power = 1;     // unit rad/s; dimensionless
  double load = 0, load_stribeck = 0;                // dimensionless
  double motor = 0, external = 0;                    // dimensionless
  double motor_stribeck = 0, external_stribeck = 0;  // dimensionless
  double motor_quad = 0, external_quad = 0;          // unit 1/(N m)
  double coasting = 0;                               // N m
  // Control law.
  double gain_ratio = 1;  // ratio of the servo's true gain to the gain in the log
  double error_bias = 0;  // rad
  double delay = 0;       // s, from the goal's time stamp until the servo uses the goal
  double slew = 100;      // rad/s; 100 means no limit in practice
  double lag = 0;         // s
  // Current limit of the motor driver, A; 1000 means no limit in practice. 16 logs of an XL330 show it: with
  // 80 % and with 100 % duty, the arm stops at the same angle.
  double most_current = 1000;
};

struct ServoParamInfo {
  std::string_view name, unit;
  double ServoParams::*at;
  double low, high;  // bounds of the parameter in a fit
  // A change of the parameter by `scale` clearly changes the predicted motion. A fit measures all changes of
  // the parameter in units of `scale`.
  double scale;
};

// Returns the parameters of model 1 to 6, in the order in which a fit uses them.
std::span<const ServoParamInfo> servo_params(int model);

// Returns the maximum friction torque, N m, at least 0. `driven` is false while the torque is off.
double friction_limit(int model, const ServoParams& params, double speed, double motor_nm,
                      double external_nm, bool driven = true);

// Inputs of the control law. The caller delays goal and torque switch by ServoParams::delay.
struct ServoCommand {
  double goal_rad = 0, volts = 0;
  double gain_per_rad = 0, most_duty = 1;
  bool torque_on = true;
  double more_duty = 0;  // added to the duty before its limit, such as the part of an I gain
};

// Control law: setpoint and duty of one servo. The angle is the servo's own reading, with the servo's zero.
class ServoLaw {
 public:
  ServoLaw(const ServoParams& params, double setpoint_rad)
      : params_(&params), setpoint_(setpoint_rad) {}

  // Advances setpoint and duty by `dt` seconds (above 0) and returns the mean duty of the step. Without
  // torque, the setpoint becomes `angle_rad`, and the duty 0. `angle_rad` is the angle in the middle of the
  // step; with the angle of its beginning, the result is less exact.
  double advance(const ServoCommand& command, double angle_rad, double dt);
  double setpoint_rad() const { return setpoint_; }

 private:
  const ServoParams* params_;
  double setpoint_, duty_ = 0;
  // Share of the duty's distance from its target that is left after a step of `dt_`, and on average in it.
  double dt_ = 0, left_ = 0, mean_left_ = 0;
};

// Control law and motor of one servo.
class ServoDrive {
 public:
  ServoDrive(const ServoParams& params, double setpoint_rad)
      : params_(&params), law_(params, setpoint_rad) {}

  // Advances the control law (ServoLaw::advance) and returns the mean motor current, A. `speed` is the speed
  // in the middle of the step, rad/s.
  double advance(const ServoCommand& command, double angle_rad, double speed, double dt);
  double setpoint_rad() const { return law_.setpoint_rad(); }

 private:
  const ServoParams* params_;
  ServoLaw law_;
};

// Returns the speed after `dt` seconds. Friction takes at most `friction_nm`, and no more than stops the
// shaft: f = -sign(t) min(|t|, friction_nm), t = inertia w / dt + torque. `inertia` includes the armature.
double speed_after(double speed, double torque_nm, double friction_nm, double inertia, double dt);

}  // namespace kaz::servo_model
