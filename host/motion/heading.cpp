// Trapezoids of the rate without its zero, and a Kalman filter of heading and zero.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/heading.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kaz::motion {

namespace {

constexpr double kDeg = std::numbers::pi / 180;

// The part that the board carries has 0.1 degrees/s per root Hz (docs/reference/simulator.md). Sampled 80
// times a
// second behind a filter of 40 Hz, in codes of 1 degree/s, that is sqrt(pi/2) as much and the codes'
// sqrt(1/12) over 40 Hz besides: 0.13.
constexpr double kNoise = 0.13 * kDeg;
// Most that a zero may be off before anything is known.
constexpr double kOffset = 20 * kDeg;
// Of the zero, degrees/s per root second: 0.5 degrees/s in 1000 s, as a walk at its beginning:
// 0.5 sqrt(2 / 1000).
constexpr double kWander = 0.022 * kDeg;
// A pause in the samples (a lost link) is not integrated over.
constexpr double kLongest_s = 0.2;
// Threshold for external rotation of a standing robot: six sigma of a sample's noise.
constexpr double kMoved = 5 * kDeg;
constexpr double kKnown = 1 * kDeg;  // of the offset's sigma, below which that can be detected

}  // namespace

Heading::Heading() : zero_2_(kOffset * kOffset) {}

void Heading::add(const host::Inertial& sample, bool still, double upright) {
  const double before = rate_;
  const double dt = seconds(sample.time - last_);
  const bool first = !started_;
  started_ = true;
  last_ = sample.time;
  if (first || dt <= 0) {
    if (first) zero_ = sample.yaw_rate_rad_per_s;
    rate_ = (sample.yaw_rate_rad_per_s - zero_) / upright;
    return;
  }
  zero_2_ += kWander * kWander * dt;
  if (dt > kLongest_s) {
    rate_ = (sample.yaw_rate_rad_per_s - zero_) / upright;
    return;
  }
  const double off = sample.yaw_rate_rad_per_s - zero_;
  if (still && (std::abs(off) < kMoved || sigma_zero() > kKnown)) {
    // The mean of a sample's time has the variance N^2 / (2 dt).
    const double all = zero_2_ + kNoise * kNoise / (2 * dt);
    const double of_zero = zero_2_ / all, of_heading = both_ / all;
    zero_ += of_zero * off;
    heading_ += of_heading * off;
    heading_2_ -= of_heading * both_;
    both_ *= 1 - of_zero;
    zero_2_ *= 1 - of_zero;
    zeroed_s_ += dt;
    rate_ = 0;
    return;
  }
  rate_ = (sample.yaw_rate_rad_per_s - zero_) / upright;
  heading_ += (before + rate_) / 2 * dt;
  heading_2_ += dt * (dt * zero_2_ - 2 * both_ + kNoise * kNoise / 2);
  both_ -= dt * zero_2_;
}

double Heading::sigma_rad() const {
  return std::sqrt(std::max(0.0, heading_2_));
}

double Heading::sigma_zero() const {
  return std::sqrt(zero_2_);
}

}  // namespace kaz::motion
