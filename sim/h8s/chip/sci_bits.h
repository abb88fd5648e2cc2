// Bits of the serial channel's registers, shared by its files. Internal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::h8s::sci_bits {

// SSR.
inline constexpr std::uint8_t kTdre = 0x80, kRdrf = 0x40, kOrer = 0x20, kFer = 0x10, kPer = 0x08;
inline constexpr std::uint8_t kErrors = kOrer | kFer | kPer;
// SCR.
inline constexpr std::uint8_t kTie = 0x80, kRie = 0x40, kTe = 0x20, kRe = 0x10, kMpie = 0x08,
                              kTeie = 0x04, kCke = 0x03;

}  // namespace kaz::h8s::sci_bits
