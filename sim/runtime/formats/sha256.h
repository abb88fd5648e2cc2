// SHA-256 of bytes, as hexadecimal digits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace kaz::sim {

std::string sha256_hex(std::span<const std::uint8_t> bytes);

// The same of two texts, such as the pictures of a pair. Where they have one length and the processor has
// instructions for SHA-256, in the time of one.
std::array<std::string, 2> sha256_hex_pair(std::span<const std::uint8_t> a,
                                           std::span<const std::uint8_t> b);

}  // namespace kaz::sim
