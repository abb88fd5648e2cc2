// Locked-rotor test: torque, voltage and current of a motor whose output shaft is held by a lever.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/motor/locked_lever.h"

#include <algorithm>
#include <cmath>

#include "sim/body/motor/joint_motor.h"

namespace kaz::sim {

LeverReading measure_locked_lever(const MotorParams& params, const LockedLever& bench) {
  constexpr double step_s = 1e-3;
  JointMotor motor(params, step_s);
  JointMotor::State state = motor.state();
  state.stopped = false;
  state.rotor_angle = std::copysign(0.5 * params.backlash_rad, bench.duty);
  motor.set_state(state);
  MotorDrive drive;
  drive.powered = true;
  LeverReading reading;
  const long steps = std::lround(bench.seconds / step_s);
  for (long i = 0; i < steps; ++i) {
    const bool off = bench.anew && i >= steps - 100 && i < steps - 50;
    drive.duty = off ? 0 : bench.duty;
    // Shaft at rest: V = V_source - R_supply I with I = duty^2 V / R_motor, so V = V_source / (1 + R_supply
    // duty^2 / R_motor). The driver limits V to max_supply_v, above which I stays constant.
    const double duty_ohms = bench.supply_ohms * drive.duty * drive.duty / motor.resistance_ohm();
    reading.terminal_volts = std::max(bench.supply_volts / (1 + duty_ohms),
                                      bench.supply_volts - duty_ohms * params.max_supply_v);
    const JointMotor::Row row = motor.prepare(drive, reading.terminal_volts, 0, 0);
    reading.torque_nm = std::clamp(row.velocity / row.softness, row.min, row.max);
    motor.finish(0, reading.torque_nm);
  }
  reading.supply_amperes = motor.supply_current();
  reading.winding_celsius = motor.winding_celsius();
  return reading;
}

}  // namespace kaz::sim
