// Digest of a picture's bytes for comparing recordings: 32 hexadecimal digits.
// SPDX-License-Identifier: Apache-2.0
//
// XXH3 with 128 bits and seed 0; `xxhsum -H2` prints the same. It detects differences but does not resist
// attackers. SHA-256 does, but takes more than seven times as long.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace kaz::sim {

std::string picture_digest(std::span<const std::uint8_t> bytes);

}  // namespace kaz::sim
