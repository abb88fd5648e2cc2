// Channel numbers that the board's sensors pass to keyed_normal(). Each random quantity has its own channel.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "shared/base/random.hpp"
#include "shared/board/board.h"

namespace kaz::sim {

// Random numbers drawn in every tick. Channels 0..KZ_ANALOG-1 belong to the inputs of the multiplexers.
constexpr std::uint64_t kImuNoise = KZ_ANALOG;       // three channels
constexpr std::uint64_t kImuWander = kImuNoise + 3;  // three channels
// Random numbers drawn only at tick 0.
constexpr std::uint64_t kImuOffset = 1000;     // three channels
constexpr std::uint64_t kPotLinearity = 2000;  // eight channels per joint
constexpr std::uint64_t kPotMounting = 3000;   // one channel per joint

// Returns a constant sensor error that differs from part to part. The error has a normal distribution with
// sigma = limit / 2 and is clamped to -limit..limit.
inline double spread(double limit, std::uint64_t seed, std::uint64_t channel) {
  return std::clamp(0.5 * limit * keyed_normal(seed, 0, channel), -limit, limit);
}

}  // namespace kaz::sim
