// Images that differ from a given one in a byte of the header, with a right CRC.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "host/flash/flash_image.h"

namespace kaz::flash_test {

// Offsets into the header: of the build id's and of the board id's last bytes.
inline constexpr std::uint32_t kBuildId = 8, kBoardId = 5;

// `original` with `flip` applied to the byte at `offset` of its application's header.
host::FlashImage variant(const host::FlashImage& original, std::uint32_t offset, std::uint8_t flip);

}  // namespace kaz::flash_test
