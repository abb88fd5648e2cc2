// Measurements of a virtual servo: motion of the shaft, and electrical values.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::sim {

// Motion and current are positive in the servo's direction.
struct ServoReading {
  // Position in steps of the position sensor. The value continues beyond a full turn and below 0. At the
  // value 0, the sensor is at the start of its range.
  double steps = 0;
  double speed = 0;      // steps/s
  double current_a = 0;  // current through the motor
  double case_celsius = 25;
  double supply_volts = 0;
};

}  // namespace kaz::sim
