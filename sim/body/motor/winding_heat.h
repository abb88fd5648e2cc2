// Thermal model of a motor: winding, case and ambient air in series.
// SPDX-License-Identifier: Apache-2.0
//
//   C_w dT_w/dt = I^2 R - (T_w - T_c) / R_wc
//   C_c dT_c/dt = (T_w - T_c) / R_wc + friction - (T_c - T_air) / R_ca
//
// (lumped network; Hendershot and Miller, "Design of Brushless Permanent-Magnet Motors", on thermal
// circuits). The copper's resistance grows linearly with T_w. Demagnetisation by heat is not modelled: it
// depends on the material, some 0.2 %/K for ferrite and half of that for neodymium. Units: J/K, K/W, W, s,
// degrees Celsius.
#pragma once

#include "sim/body/description/motor_file.h"

namespace kaz::sim {

class WindingHeat {
 public:
  explicit WindingHeat(const MotorParams& params)
      : params_(params), winding_(params.air_celsius), case_(params.air_celsius) {}

  // W of the copper and of gear and brushes during step_s. Explicit: the step is 1e-5 of the shortest
  // time constant. Nothing happens where the motor file says nothing of heat.
  void take(double copper_watts, double friction_watts, double step_s);
  // Resistance now over resistance at `air_celsius`.
  double resistance_ratio() const {
    return 1 + params_.copper_per_kelvin * (winding_ - params_.air_celsius);
  }
  double winding_celsius() const { return winding_; }
  double case_celsius() const { return case_; }
  void set(double winding_celsius, double case_celsius) {
    winding_ = winding_celsius;
    case_ = case_celsius;
  }

  // Archives the state (archive.h).
  template <class A>
  void transfer(A& a) {
    a(winding_, case_);
  }

 private:
  MotorParams params_;
  double winding_, case_;
};

}  // namespace kaz::sim
