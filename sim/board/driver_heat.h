// Temperature of the motor drivers, heated by the motors' currents.
// SPDX-License-Identifier: Apache-2.0
//
//   time_constant dT/dt = ambient + kelvin_per_watt P - T,  P = drop_volts * sum |motor current|
//
// For constant motor currents, advance() solves the equation exactly. Units: K, s, W.
#pragma once

#include <cmath>

#include "sim/board/sensor_file.h"

namespace kaz::sim {

class DriverHeat {
 public:
  explicit DriverHeat(const DriverParams& params)
      : params_(params), celsius_(params.ambient_celsius) {}

  // Advances the temperature by `seconds` with constant motor currents. `amperes` is the sum of the
  // magnitudes of these currents.
  void advance(double seconds, double amperes) {
    const double end =
        params_.ambient_celsius + params_.kelvin_per_watt * params_.drop_volts * amperes;
    celsius_ = end + (celsius_ - end) * std::exp(-seconds / params_.time_constant_s);
  }
  double celsius() const { return celsius_; }

  // Archives the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(celsius_);
  }

 private:
  DriverParams params_;
  double celsius_;
};

}  // namespace kaz::sim
