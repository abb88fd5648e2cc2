// XXH3 by its library's header, so that no program is linked to it.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/picture_digest.h"

#include "shared/base/hex_text.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace kaz::sim {

std::string picture_digest(std::span<const std::uint8_t> bytes) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits(bytes.data(), bytes.size()));
  return hex_text(canonical.digest);
}

}  // namespace kaz::sim
