// Friction of a geared servo: six models of increasing detail.
// SPDX-License-Identifier: Apache-2.0
//
// Source: Duclusaud, Passault, Padois, Ly, "Extended Friction Models for the Physics Simulation of Servo
// Actuators", ICRA 2025 (arXiv 2410.08650). All quantities are at the output shaft, in SI units.
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
#pragma once

#include <array>
#include <span>
#include <string_view>

namespace kaz::hil {

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
  // Fitted parameters of the servo's control law and of the test stand.
  double gain_ratio = 1;  // ratio of the servo's true gain to the gain in the log
  double offset = 0;      // measured angle minus true angle, rad
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

// Returns the maximum friction torque, N m, at least 0.
double friction_limit(int model, const ServoParams& params, double speed, double motor_nm,
                      double external_nm);

}  // namespace kaz::hil
