// Angle and angular speed of something, from noisy measurements at irregular times.
// SPDX-License-Identifier: Apache-2.0
//
// Kalman filter of a point of nearly constant speed, disturbed by white-noise acceleration: Y.
// Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and Navigation",
// 2001, section 6.2.2.
#pragma once

#include <optional>

#include "vision/frame.h"  // Time

namespace kaz::behavior {

class AngleFilter {
 public:
  struct Noise {
    double measurement_rad = 0;   // standard deviation of one measurement
    double acceleration_psd = 0;  // rad^2/s^3, power spectral density of the acceleration
    double initial_rate =
        0;                // rad/s, standard deviation of the speed before the second measurement
    double jump_rad = 0;  // a measurement that far from what was expected starts the filter anew
  };
  explicit AngleFilter(const Noise& noise) : noise_(noise) {}

  // A measurement that is not newer than the last one is ignored.
  void observe(Time t, double angle_rad);
  void forget() { known_ = false; }

  bool known() const { return known_; }
  Time latest() const { return latest_; }
  double rate() const { return rate_; }  // rad/s
  // The most likely angle at `t`: straight on with the present speed. known() must hold.
  double at(Time t) const { return angle_ + rate_ * seconds(t - latest_); }
  // The same for aiming: a speed that may as well be noise is believed less, by the factor rate^2 /
  // (rate^2 + variance of rate), so that something at rest is not chased about. known() must hold.
  double aim(Time t) const;

 private:
  void start(Time t, double angle_rad);

  Noise noise_;
  bool known_ = false;
  Time latest_{};
  double angle_ = 0, rate_ = 0;
  double p_angle_ = 0, p_cross_ = 0, p_rate_ = 0;  // covariance
};

}  // namespace kaz::behavior
