// SHA-256 by OpenSSL.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/sha256.h"

#include <openssl/sha.h>

#include <array>

namespace kaz::sim {

std::string hex(std::span<const std::uint8_t> bytes) {
  static constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

std::string sha256_hex(std::span<const std::uint8_t> bytes) {
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
  SHA256(bytes.data(), bytes.size(), digest.data());
  return hex(digest);
}

}  // namespace kaz::sim
