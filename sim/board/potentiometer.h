// Potentiometer of one joint: converts the angle of the output shaft to a fraction of AVCC.
// SPDX-License-Identifier: Apache-2.0
//
// The potentiometer has a track of 190 degrees (KZ_POT_RANGE_DECIDEG) with a terminal at each end. The
// position of the wiper is
//
//   x = 1/2 + sign (angle + offset - center) / range
//
// For each joint, the file joints.def contains `sign` and `center`. The name of `center` in joints.def is
// `pot_centre`. While the wiper is on the track, the output is `x + e(x)`. The linearity error `e` is a sum
// of three sine waves with 1, 2 and 3 half periods along the track. By the definition of terminal-based
// linearity, `e` is zero at both ends of the track. On a terminal the output is 0 or 1. Beyond a terminal
// the wiper is open, and a pull-up resistor determines the level.
#pragma once

#include <array>
#include <cstdint>

#include "sim/board/sensor_file.h"

namespace kaz::sim {

// Returns the output of a nominal potentiometer as a fraction of AVCC. Beyond the ends of the track, the
// output is 0 or 1.
double pot_ratio(int joint, double angle_rad);

class Potentiometer {
 public:
  Potentiometer() = default;
  // `seed` determines the linearity error and the offset. If `switches.pot_as_built` is false, the linearity
  // error and the offset are 0.
  Potentiometer(int joint, const PotentiometerParams& params, const SensorSwitches& switches,
                std::uint64_t seed);

  // Returns the output as a fraction of AVCC, 0..1, without noise.
  double ratio(double angle_rad) const;
  double offset_rad() const { return offset_rad_; }

 private:
  int joint_ = 0;
  bool opens_ = false;
  double terminal_rad_ = 0, open_level_ = 1;
  double offset_rad_ = 0;
  // Amplitudes of the sine waves. The sum of the magnitudes of the amplitudes is at most
  // PotentiometerParams::linearity.
  std::array<double, 3> waves_{};
};

}  // namespace kaz::sim
