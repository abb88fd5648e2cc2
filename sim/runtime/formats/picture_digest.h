// Digest of a picture's bytes, by which recordings are compared: 32 hexadecimal digits.
// SPDX-License-Identifier: Apache-2.0
//
// Poly1305 (RFC 8439) with the fixed key 00 01 02 .. 1f, a polynomial over the field of integers modulo
// 2^130 - 5. Two different pictures have the same digest by chance only, below 1e-26 for a random key and a
// picture of 1 MB; a digest that withstands an attacker (SHA-256) takes seven times as long.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Error (environment): OpenSSL has no Poly1305.
Result<std::string> picture_digest(std::span<const std::uint8_t> bytes);

}  // namespace kaz::sim
