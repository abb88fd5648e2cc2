// The motor file: parameters of the gear motor that drives each joint.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "shared/base/result.hpp"
#include "shared/servo_model/servo_file.h"

namespace kaz::sim {

// Parameters of a gear motor at the output shaft, in SI units. The torque of a cold motor is
// `stall_slope * V * duty - back_emf * w - friction`. V is the supply voltage, w the speed of the shaft in
// rad/s. The duty is -1..1.
struct MotorParams {
  std::string name;
  double stall_slope_nm_per_v = 0;
  double friction_nm = 0;           // Coulomb friction of gear and brushes
  double back_emf_nms_per_rad = 0;  // torque that the motor loses per rad/s of speed
  double stiction_ratio = 1;        // ratio of breakaway torque to friction_nm
  double rotor_inertia_kgm2 = 0;
  double max_supply_v = 0;  // maximum output voltage of the driver
  // Losses and limit of the joint, from the robot's file; motor files do not contain them.
  double damping_nms_per_rad = 0;  // viscous friction, with and without power
  double max_drive_nm = 1e3;       // maximum of the torque that the current produces

  double backlash_rad = 0;  // backlash: free travel between the gear's flanks
  // Heat capacities (J/K) and thermal resistances (K/W) of the model in winding_heat.h. If
  // winding_heat_capacity is 0, the motor stays cold.
  double winding_heat_capacity = 0, winding_to_case = 0;
  double case_heat_capacity = 0, case_to_air = 0;
  double copper_per_kelvin = 0;  // relative increase of the winding's resistance per K
  double air_celsius = 25;       // ambient temperature; also the temperature of the cold motor

  // Identified servo, or null. It sets the numbers of the motor above, except those that the motor file
  // replaces. Its friction (friction_limit()) then acts instead of `stiction_ratio` and the motor's own part
  // of `friction_nm`, and there is no backlash.
  std::shared_ptr<const servo_model::IdentifiedServo> servo = nullptr;

  // Returns the torque constant K in Nm/A, assuming that `friction_nm` is the gear's only loss. K equals the
  // back-EMF constant (V s/rad). K is computed from two equations that contain the winding's resistance R:
  // stall_slope = K / R and back_emf = K^2 / R.
  double torque_constant() const { return back_emf_nms_per_rad / stall_slope_nm_per_v; }
  double resistance_ohm() const { return torque_constant() / stall_slope_nm_per_v; }

  bool operator==(const MotorParams&) const = default;

  // Returns the same motor without backlash and heat.
  MotorParams ideal() const;
};

// Makes the numbers of `motor` those of an identified servo. Heat, supply and name stay.
void use_servo(MotorParams& motor, servo_model::IdentifiedServo servo);

// Loads the motor `name`, or the file's default motor if `name` is empty. <servo name="..."/> names a shipped
// identified servo, and <servo file="..."/> a servo file, relative to the folder of the motor file. An error
// message names file and line.
Result<MotorParams> load_motor_file(const std::string& path, const std::string& name);

// Returns the text of a motor file that contains only this motor, as the default motor. `about` is a
// description of the origin of the numbers; the text contains this description as a comment.
// When load_motor_file() reads this text, it returns the numbers of `motor`, with two exceptions. The
// backlash can have a rounding error. If `motor.winding_heat_capacity` is 0, the text contains no parameter
// of the heat model except `air_celsius`. Precondition: `motor.servo` is null.
std::string motor_file_text(const MotorParams& motor, const std::string& about);

}  // namespace kaz::sim
