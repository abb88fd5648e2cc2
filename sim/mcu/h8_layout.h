// Decodes the tick's input, output and startup structures from the H8's memory.
// SPDX-License-Identifier: Apache-2.0
//
// The H8 compiler stores numbers big-endian. Numbers of more than one byte start at even offsets; there is no
// other padding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/servo/tick.h"

namespace kaz::sim::h8_layout {

inline constexpr std::size_t kInputSize = 4 + 4 * 2 + 2 * KZ_ANALOG + 5 + 2 * KZ_RX_PER_TICK + 1;
inline constexpr std::size_t kStartupSize = 2 * 2 + 6 + 2 * 2 * KZ_JOINTS;
inline constexpr std::size_t kOutputSize = 16 + 2 + 4 + 2 + KZ_TX_PER_TICK;

kz_startup decode_startup(std::span<const std::uint8_t, kStartupSize> bytes);
kz_tick_input decode_input(std::span<const std::uint8_t, kInputSize> bytes);
kz_tick_output decode_output(std::span<const std::uint8_t, kOutputSize> bytes);

// Returns the big-endian number of `size` bytes (1, 2 or 4) at offset `at`.
std::uint32_t number(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size);

}  // namespace kaz::sim::h8_layout
