// For tests: images that differ from a given one in a byte of the header, with a valid CRC.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "host/flash/flash_image.h"

namespace kaz::flash_test {

// Offsets in the header of the last bytes of build id and board id.
inline constexpr std::uint32_t kBuildId = 8, kBoardId = 5;

// Returns `original` with the bits of `flip` inverted in the byte at `offset` of its application's header.
host::FlashImage variant(const host::FlashImage& original, std::uint32_t offset, std::uint8_t flip);

}  // namespace kaz::flash_test
