// Random numbers of an episode's scenario: the same on all machines, each purpose with its own stream.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "shared/base/random.hpp"

namespace kaz::tools {

// What random numbers are for.
enum class Draw : std::uint64_t {
  friction = 301,
  supply,
  distance,
  bearing,
  radius,
  color,
  floor,
  mass,
  start_x,
  start_y,
  start_yaw,
  lamp_azimuth,
  lamp_height,
  lamp,
  shade,
  obstacles,
  goal,
  paint,
  lies,
  clutter,
  pushes
};

// 0..1, from a normal deviate, which is keyed alike on all machines.
inline double from_normal(double normal) {
  return std::clamp(0.5 * std::erfc(-normal / std::numbers::sqrt2), 0.0, 1.0);
}

// Evenly distributed, one after the other.
class Dice {
 public:
  Dice(std::uint64_t seed, Draw what) : seed_(seed), what_(what) {}
  double operator()(double from, double to) {
    return from + (to - from) * from_normal(keyed_normal(seed_, ++number_,
                                                         static_cast<std::uint64_t>(what_)));
  }
  // 0 to `count` - 1.
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>((*this)(0, static_cast<double>(count) - 0.001));
  }
  double side() { return (*this)(0, 1) < 0.5 ? -1 : 1; }

 private:
  std::uint64_t seed_, number_ = 0;
  Draw what_;
};

}  // namespace kaz::tools
