// Trapezoids of the rate without its zero; the zero is a mean over time spent still.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/heading.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kaz::motion {

namespace {

// The zero wanders with temperature: an old mean is worth no more than this much time of a new one.
constexpr double kMemory_s = 10;
// Noise of the part that the board carries (docs/simulator.md): 0.1 degrees/s per root Hz.
constexpr double kNoise = 0.1 * std::numbers::pi / 180;
// A pause in the samples (a lost link) is not integrated over.
constexpr double kLongest_s = 0.2;

}  // namespace

void Heading::add(const host::Inertial& sample, bool still, double upright) {
  const double before = rate_;
  const double dt = seconds(sample.time - last_);
  const bool first = !started_;
  started_ = true;
  last_ = sample.time;
  if (first || dt <= 0 || dt > kLongest_s) {
    if (first) zero_ = sample.yaw_rate_rad_per_s;
    rate_ = (sample.yaw_rate_rad_per_s - zero_) / upright;
    return;
  }
  if (still) {
    const double weight = dt / std::min(zeroed_s_ + dt, kMemory_s);
    zero_ += weight * (sample.yaw_rate_rad_per_s - zero_);
    zeroed_s_ += dt;
    rate_ = 0;
    return;
  }
  rate_ = (sample.yaw_rate_rad_per_s - zero_) / upright;
  heading_ += (before + rate_) / 2 * dt;
  moving_s_ += dt;
}

// The mean over T s of noise of density N is off by N / sqrt(2 T) rad/s; that grows with time, the
// integral of the noise itself with its root.
double Heading::sigma_rad() const {
  const double zero = zeroed_s_ > 0 ? kNoise / std::sqrt(2 * std::min(zeroed_s_, kMemory_s)) : 1.0;
  return std::hypot(zero * moving_s_, kNoise * std::sqrt(moving_s_ / 2));
}

}  // namespace kaz::motion
