// Portable random numbers: the same on every machine and with every standard library.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace kaz {

// One step of SplitMix64 (Steele, Lea and Flood 2014), also usable as a hash of 64 bits.
constexpr std::uint64_t mix64(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

// SplitMix64 generator. Not thread-safe.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    const std::uint64_t value = mix64(state_);
    state_ += 0x9E3779B97F4A7C15u;
    return value;
  }
  // Returns 0 <= result < bound; bound > 0. The bias is at most bound / 2^32.
  std::uint32_t below(std::uint32_t bound) {
    return static_cast<std::uint32_t>(((next() >> 32) * bound) >> 32);
  }
  // Returns 0 <= result < 1.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  // Returns true with the given probability.
  bool chance(double probability) { return uniform() < probability; }

  // Saves or restores the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(state_);
  }

 private:
  std::uint64_t state_;
};

// Returns a normal deviate (mean 0, sigma 1) that depends only on the three arguments, not on earlier calls.
// Source: Box and Muller 1958.
inline double keyed_normal(std::uint64_t seed, std::uint64_t tick, std::uint64_t channel) {
  const std::uint64_t key = mix64(mix64(mix64(seed) ^ tick) ^ channel);
  const double u = (static_cast<double>(key >> 11) + 1.0) * 0x1p-53;  // 0 < u <= 1
  const double v = static_cast<double>(mix64(key) >> 11) * 0x1p-53;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * v);
}

}  // namespace kaz
