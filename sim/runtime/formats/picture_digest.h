// Digest of a picture's bytes, by which recordings are compared: 32 hexadecimal digits.
// SPDX-License-Identifier: Apache-2.0
//
// XXH3 of 128 bits, seed 0 (`xxhsum -H2` prints the same): it shows that bytes differ, and withstands no
// attacker. SHA-256, which does, took seven times as long as one that is slower than this.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace kaz::sim {

std::string picture_digest(std::span<const std::uint8_t> bytes);

}  // namespace kaz::sim
