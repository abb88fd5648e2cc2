// Measurements of a virtual servo: motion of the shaft, and electrical values.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::sim {

// Motion and current are positive in the servo's direction.
struct ServoReading {
  // Reading of the position sensor in steps, not wrapped; 0 is the start of the sensor's first turn.
  double steps = 0;
  double speed = 0;      // steps/s
  double current_a = 0;  // current through the motor
  double case_celsius = 25;
  double supply_volts = 0;
};

}  // namespace kaz::sim
