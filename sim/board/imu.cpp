// The board option of AN3..AN5: yaw-rate gyro and two-axis accelerometer.
// SPDX-License-Identifier: Apache-2.0
#include "sim/board/imu.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/board/noise_key.h"

namespace kaz::sim {

Imu::Imu(const SensorParams& params, const SensorSwitches& switches, std::uint64_t seed)
    : seed_(seed) {
  constexpr double tick_s = 1.0 / KZ_TICK_HZ;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Axis& axis = axes_[i];
    axis.params = i == 0 ? params.gyro : params.accelerometer;
    axis.real = i == 0 ? switches.gyro : switches.accelerometer;
    if (!axis.real) continue;
    axis.offset = spread(axis.params.zero_offset, seed, kImuOffset + i);
    axis.stay = std::exp(-tick_s / axis.params.wander_time_s);
    axis.stir = axis.params.wander * std::sqrt(1 - axis.stay * axis.stay);
    axis.wandered = axis.params.wander * keyed_normal(seed, 0, kImuWander + i);
    axis.sigma = axis.params.noise_density * std::sqrt(0.5 / tick_s);
    axis.follow = 1 - std::exp(-2 * std::numbers::pi * axis.params.bandwidth_hz * tick_s);
  }
}

void Imu::advance(std::int64_t tick, const ImuMotion& motion) {
  const std::array<double, 3> measured{motion.yaw_rate, motion.forward_force, motion.left_force};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Axis& axis = axes_[i];
    double input = measured[i];
    if (!started_) axis.filtered = input;  // it was on, and at rest, before the run began
    if (axis.sigma > 0)
      input += axis.sigma * keyed_normal(seed_, static_cast<std::uint64_t>(tick), kImuNoise + i);
    if (axis.stir > 0) {
      axis.wandered =
          axis.stay * axis.wandered +
          axis.stir * keyed_normal(seed_, static_cast<std::uint64_t>(tick), kImuWander + i);
    }
    axis.filtered += axis.follow * (input - axis.filtered);
  }
  started_ = true;
}

void Imu::follow(const Imu& other) {
  started_ = other.started_;
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].filtered = other.axes_[i].filtered;
}

double Imu::ratio(int index) const {
  const Axis& axis = axes_[static_cast<std::size_t>(index)];
  double value = axis.filtered + axis.offset + axis.wandered;
  if (axis.real) value = std::clamp(value, -axis.params.range, axis.params.range);
  return std::clamp(0.5 + axis.params.share_per_unit * value, 0.0, 1.0);
}

}  // namespace kaz::sim
