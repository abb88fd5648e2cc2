// Random numbers of an episode's scenario: equal on all machines, with one stream per purpose.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "shared/base/random.hpp"

namespace kaz::tools {

// Purpose of a random number. The value of the enumerator is the key of the purpose's stream.
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

// Maps a normally distributed random number to a uniformly distributed one, 0 to 1. The normal numbers come
// from keyed_normal(), because keyed_normal() returns the same numbers on all machines.
inline double from_normal(double normal) {
  return std::clamp(0.5 * std::erfc(-normal / std::numbers::sqrt2), 0.0, 1.0);
}

// Uniform random numbers, drawn in sequence.
class Dice {
 public:
  Dice(std::uint64_t seed, Draw what) : seed_(seed), what_(what) {}
  double operator()(double from, double to) {
    return from + (to - from) * from_normal(keyed_normal(seed_, ++number_,
                                                         static_cast<std::uint64_t>(what_)));
  }
  // Returns a random integer, 0 to `count` - 1.
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>((*this)(0, static_cast<double>(count) - 0.001));
  }
  // Returns -1 or 1.
  double side() { return (*this)(0, 1) < 0.5 ? -1 : 1; }

 private:
  std::uint64_t seed_, number_ = 0;
  Draw what_;
};

}  // namespace kaz::tools
