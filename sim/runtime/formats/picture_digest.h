// Digest of a picture's bytes, for comparing recordings: 32 hexadecimal digits.
// SPDX-License-Identifier: Apache-2.0
//
// The digest is XXH3 with 128 bits and seed 0; `xxhsum -H2` prints the same digits. The digest detects
// accidental differences but does not resist attackers. SHA-256 would resist attackers but takes more than
// seven times as long as XXH3.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace kaz::sim {

std::string picture_digest(std::span<const std::uint8_t> bytes);

}  // namespace kaz::sim
