// Names of the I/O registers and of their bits, made from registers.def.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace kaz::h8s {

// Low 16 bits of the address of each register: io::SCR0.
namespace io {
#define KZ_REGISTER(name, address, size, unit) inline constexpr std::uint32_t name = address;
#define KZ_ABSENT KZ_REGISTER
#include "sim/h8s/chip/registers.def"
}  // namespace io

// Masks of bits and fields, in a namespace for each register: SCR::TIE.
#define KZ_BITS(group, ...)                  \
  namespace group {                          \
  inline constexpr std::uint8_t __VA_ARGS__; \
  }
#include "sim/h8s/chip/registers.def"

// Returns the number in a field: field<SBYCR::STS>(value).
template <std::uint8_t mask>
constexpr unsigned field(auto value) {
  constexpr int shift = std::countr_zero(mask);
  return value >> shift & unsigned{mask} >> shift;
}

}  // namespace kaz::h8s
