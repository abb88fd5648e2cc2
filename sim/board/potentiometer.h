// Potentiometer of one joint: converts the angle of the output shaft to a fraction of AVCC.
// SPDX-License-Identifier: Apache-2.0
//
// A track of 190 degrees (KZ_POT_RANGE_DECIDEG) with a terminal at each end. The wiper's position is
//
//   x = 1/2 + sign (angle + offset - center) / range
//
// with sign and center (pot_centre) from joints.def. On the track the output is x + e(x). The linearity error
// e is a sum of three sine half waves. It is zero at both ends of the track, according to the definition of
// terminal-based linearity. On a terminal the output is 0 or 1. Beyond a terminal the wiper is open, and a
// pull-up resistor determines the level.
#pragma once

#include <array>
#include <cstdint>

#include "sim/board/sensor_file.h"

namespace kaz::sim {

// Returns the output of a nominal potentiometer as a fraction of AVCC, clamped beyond the ends of the track.
double pot_ratio(int joint, double angle_rad);

class Potentiometer {
 public:
  Potentiometer() = default;
  // `seed` determines linearity error and offset. Both are only applied if enabled in `switches`.
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
  // Amplitudes; the sum of their magnitudes is at most the linearity error.
  std::array<double, 3> waves_{};
};

}  // namespace kaz::sim
