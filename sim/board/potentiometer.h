// One joint's potentiometer: from the angle of the output shaft to a fraction of AVCC.
// SPDX-License-Identifier: Apache-2.0
//
// A track of 190 degrees (KZ_POT_RANGE_DECIDEG) with a terminal at each end. The wiper's position is
//   x = 1/2 + sign (angle + offset - centre) / range,
// sign and centre from joints.def. On the track the output is x + e(x), where e is the element's
// linearity error: a sum of three half waves, zero at both ends, as terminal-based linearity is
// defined. On a terminal it is 0 or 1. Beyond, the wiper is open and the input's pull-up decides.
#pragma once

#include <array>
#include <cstdint>

#include "sim/board/sensor_file.h"

namespace kaz::sim {

// Output of a nominal potentiometer, fraction of AVCC, for a joint angle in rad; clamped beyond +-95
// degrees.
double pot_ratio(int joint, double angle_rad);

class Potentiometer {
 public:
  Potentiometer() = default;
  // `seed` selects linearity error and offset, which are applied if enabled in `switches`.
  Potentiometer(int joint, const PotentiometerParams& params, const SensorSwitches& switches,
                std::uint64_t seed);

  // Fraction of AVCC, 0..1, without noise.
  double ratio(double angle_rad) const;
  double offset_rad() const { return offset_rad_; }

 private:
  int joint_ = 0;
  bool opens_ = false;
  double terminal_rad_ = 0, open_level_ = 1;
  double offset_rad_ = 0;
  std::array<double, 3> waves_{};  // fractions; magnitudes add up to less than the linearity error
};

}  // namespace kaz::sim
