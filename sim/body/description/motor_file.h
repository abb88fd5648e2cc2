// The motor file: parameters of the gear motor that drives each joint.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// All at the output shaft, SI units. Motor line, cold: torque = stall_slope V duty - back_emf w - friction,
// with the supply voltage V, duty -1 .. 1 and the speed w, rad/s.
struct MotorParams {
  std::string name;
  double stall_slope_nm_per_v = 0;
  double friction_nm = 0;           // Coulomb, gear and brushes together
  double back_emf_nms_per_rad = 0;  // loss of torque with speed
  double stiction_ratio = 1;        // breakaway torque / friction_nm
  double rotor_inertia_kgm2 = 0;
  double max_supply_v = 0;  // limit of the driver's output voltage

  double backlash_rad = 0;  // free travel between the flanks; 0: none
  // Heat (winding_heat.h): J/K and K/W. Without winding_heat_capacity the motor stays cold.
  double winding_heat_capacity = 0, winding_to_case = 0;
  double case_heat_capacity = 0, case_to_air = 0;
  double copper_per_kelvin = 0;  // growth of the resistance
  double air_celsius = 25;       // at which the motor line holds

  // Derived with a gear whose only loss is `friction_nm`: the torque constant K (Nm/A) then equals the
  // back-EMF constant (Vs/rad), and slope = K / R, back_emf = K^2 / R.
  double torque_constant() const { return back_emf_nms_per_rad / stall_slope_nm_per_v; }
  double resistance_ohm() const { return torque_constant() / stall_slope_nm_per_v; }

  bool operator==(const MotorParams&) const = default;

  // The same motor without backlash and heat.
  MotorParams ideal() const;
};

// The motor called `name`, or the file's default where `name` is empty. Errors name file and line.
Result<MotorParams> load_motor_file(const std::string& path, const std::string& name);

// Text of a motor file with this motor alone, as its default. `about`: comment on its origin.
// load_motor_file() reads the same numbers from it, bit for bit except the backlash.
std::string motor_file_text(const MotorParams& motor, const std::string& about);

}  // namespace kaz::sim
