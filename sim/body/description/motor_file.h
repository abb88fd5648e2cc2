// The motor file: parameters of the gear motor that drives each joint.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Parameters at the output shaft, SI units. A cold motor with supply voltage V, duty -1..1 and speed w
// (rad/s) has the torque stall_slope V duty - back_emf w - friction.
struct MotorParams {
  std::string name;
  double stall_slope_nm_per_v = 0;
  double friction_nm = 0;           // Coulomb friction of gear and brushes
  double back_emf_nms_per_rad = 0;  // torque lost per rad/s of speed
  double stiction_ratio = 1;        // breakaway torque / friction_nm
  double rotor_inertia_kgm2 = 0;
  double max_supply_v = 0;  // limit of the driver's output voltage

  double backlash_rad = 0;  // free travel between the flanks
  // Thermal model (winding_heat.h), J/K and K/W. With a winding_heat_capacity of 0 the motor stays cold.
  double winding_heat_capacity = 0, winding_to_case = 0;
  double case_heat_capacity = 0, case_to_air = 0;
  double copper_per_kelvin = 0;  // relative growth of the resistance per K
  double air_celsius = 25;       // ambient temperature; also the temperature of the cold motor

  // Torque constant K, Nm/A, assuming that `friction_nm` is the gear's only loss. Then K equals the back-EMF
  // constant (V s/rad), stall_slope = K / R and back_emf = K^2 / R, where R is the winding's resistance.
  double torque_constant() const { return back_emf_nms_per_rad / stall_slope_nm_per_v; }
  double resistance_ohm() const { return torque_constant() / stall_slope_nm_per_v; }

  bool operator==(const MotorParams&) const = default;

  // Returns the same motor without backlash and heat.
  MotorParams ideal() const;
};

// Loads the motor `name`, or the file's default motor if `name` is empty. Errors name file and line.
Result<MotorParams> load_motor_file(const std::string& path, const std::string& name);

// Returns the text of a motor file that contains only this motor, as the default motor. `about` becomes a
// comment on the origin of the numbers. load_motor_file() reads the same numbers from this text, bit for bit
// except the backlash.
std::string motor_file_text(const MotorParams& motor, const std::string& about);

}  // namespace kaz::sim
