// Poly1305 by OpenSSL.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/picture_digest.h"

#include <openssl/evp.h>

#include <array>
#include <memory>
#include <numeric>

#include "shared/base/hex_text.hpp"

namespace kaz::sim {

Result<std::string> picture_digest(std::span<const std::uint8_t> bytes) {
  static EVP_MAC* const poly1305 = EVP_MAC_fetch(nullptr, "POLY1305", nullptr);
  const std::unique_ptr<EVP_MAC_CTX, decltype(&EVP_MAC_CTX_free)> context(
      poly1305 == nullptr ? nullptr : EVP_MAC_CTX_new(poly1305), EVP_MAC_CTX_free);
  std::array<std::uint8_t, 32> key{};
  std::iota(key.begin(), key.end(), std::uint8_t{0});
  std::array<std::uint8_t, 16> digest{};
  std::size_t size = 0;
  if (!context || EVP_MAC_init(context.get(), key.data(), key.size(), nullptr) != 1 ||
      EVP_MAC_update(context.get(), bytes.data(), bytes.size()) != 1 ||
      EVP_MAC_final(context.get(), digest.data(), &size, digest.size()) != 1 ||
      size != digest.size())
    return fail(Fault::environment, "OpenSSL has no Poly1305; check the libssl installation");
  return hex_text(digest);
}

}  // namespace kaz::sim
