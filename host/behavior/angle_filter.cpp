// Prediction and correction of the two-state Kalman filter.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/angle_filter.h"

#include <cmath>

namespace kaz::behavior {

void AngleFilter::start(Time t, double angle_rad) {
  known_ = true;
  latest_ = t;
  angle_ = angle_rad;
  rate_ = 0;
  p_angle_ = noise_.measurement_rad * noise_.measurement_rad;
  p_cross_ = 0;
  p_rate_ = noise_.initial_rate * noise_.initial_rate;
}

void AngleFilter::observe(Time t, double angle_rad) {
  if (!known_) return start(t, angle_rad);
  const double dt = seconds(t - latest_);
  if (dt <= 0) return;
  const double expected = at(t);
  if (std::abs(angle_rad - expected) > noise_.jump_rad) return start(t, angle_rad);

  const double q = noise_.acceleration_psd;
  p_angle_ += dt * (2 * p_cross_ + dt * p_rate_) + q * dt * dt * dt / 3;
  p_cross_ += dt * p_rate_ + q * dt * dt / 2;
  p_rate_ += q * dt;

  const double spread = p_angle_ + noise_.measurement_rad * noise_.measurement_rad;
  const double gain = p_angle_ / spread, rate_gain = p_cross_ / spread;
  const double surprise = angle_rad - expected;
  angle_ = expected + gain * surprise;
  rate_ += rate_gain * surprise;
  p_rate_ -= rate_gain * p_cross_;
  p_cross_ *= 1 - gain;
  p_angle_ *= 1 - gain;
  latest_ = t;
}

double AngleFilter::aim(Time t) const {
  const double power = rate_ * rate_;
  if (power == 0) return angle_;
  return angle_ + rate_ * power / (power + p_rate_) * seconds(t - latest_);
}

}  // namespace kaz::behavior
