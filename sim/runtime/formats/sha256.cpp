// SHA-256 by OpenSSL.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/sha256.h"

#include <openssl/sha.h>

#include <array>

#include "shared/base/hex_text.hpp"

namespace kaz::sim {

std::string sha256_hex(std::span<const std::uint8_t> bytes) {
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
  SHA256(bytes.data(), bytes.size(), digest.data());
  return hex_text(digest);
}

}  // namespace kaz::sim
