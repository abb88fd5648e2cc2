// Thermal model of a motor: winding, case and ambient air in series.
// SPDX-License-Identifier: Apache-2.0
//
//   C_w dT_w/dt = I^2 R - (T_w - T_c) / R_wc
//   C_c dT_c/dt = (T_w - T_c) / R_wc + friction - (T_c - T_air) / R_ca
//
// Source: the text about thermal circuits (lumped networks) in Hendershot and Miller, "Design of Brushless
// Permanent-Magnet Motors". The copper's resistance grows linearly with T_w. The weakening of the magnets by
// heat is not modeled. Ferrite magnets weaken by about 0.2 %/K, neodymium magnets by 0.1 %/K. Units: J/K,
// K/W, W, s, degrees Celsius.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "sim/body/description/motor_file.h"

namespace kaz::sim {

class WindingHeat {
 public:
  explicit WindingHeat(std::shared_ptr<const MotorParams> params)
      : params_(std::move(params)), winding_(params_->air_celsius), case_(params_->air_celsius) {}

  // Computes the temperatures after a step of `step_s` seconds. During the step, the copper heats the winding
  // with the power `copper_watts`. Gear and brushes heat the case with the power `friction_watts`. Explicit
  // Euler is accurate enough, because the shortest time constant is about 100,000 steps long. If the motor
  // file has no heat parameters, the motor stays cold.
  void take(double copper_watts, double friction_watts, double step_s) {
    if (params_->winding_heat_capacity == 0) return;
    const double to_case = (winding_ - case_) / params_->winding_to_case;
    const double to_air = (case_ - params_->air_celsius) / params_->case_to_air;
    winding_ += step_s * (copper_watts - to_case) / params_->winding_heat_capacity;
    case_ += step_s * (to_case + friction_watts - to_air) / params_->case_heat_capacity;
  }
  // Ratio of the present resistance to the resistance at `air_celsius`.
  double resistance_ratio() const {
    return 1 + params_->copper_per_kelvin * (winding_ - params_->air_celsius);
  }
  double winding_celsius() const { return winding_; }
  double case_celsius() const { return case_; }
  void set(double winding_celsius, double case_celsius) {
    winding_ = winding_celsius;
    case_ = case_celsius;
  }

  // Archives the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(winding_, case_);
    // In this linear model, the resistance of copper falls to zero at a temperature far below -150 degrees
    // Celsius.
    a.require(std::min(winding_, case_) > -150 && std::max(winding_, case_) < 1e5, "temperature");
  }

 private:
  std::shared_ptr<const MotorParams> params_;
  double winding_, case_;
};

}  // namespace kaz::sim
