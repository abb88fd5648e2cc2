// Computes the SHA-256 of bytes as hexadecimal digits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace kaz::sim {

std::string sha256_hex(std::span<const std::uint8_t> bytes);

}  // namespace kaz::sim
