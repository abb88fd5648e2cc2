// A changed header and its CRC.
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/flash/variant_testing.h"

#include <array>

#include "host/flash/writer_link.h"

namespace kaz::flash_test {

host::FlashImage variant(const host::FlashImage& original, std::uint32_t offset,
                         std::uint8_t flip) {
  host::FlashImage image = original;
  const auto put = [&](std::uint32_t at, std::uint8_t byte) { image.put(at, std::array{byte}); };
  const std::uint32_t at = KZ_APPLICATION_HEADER + offset;
  put(at, static_cast<std::uint8_t>(image.bytes({at, at + 1})[0] ^ flip));
  host::WriterSums sums;
  const std::uint32_t end = KZ_APPLICATION + image.identity()->length;
  for (std::uint32_t a = KZ_APPLICATION; a < end; ++a)
    if (a / 2 != (KZ_APPLICATION_HEADER + 30) / 2) sums.add(image.bytes({a, a + 1})[0]);
  put(KZ_APPLICATION_HEADER + 30, static_cast<std::uint8_t>(sums.crc >> 8));
  put(KZ_APPLICATION_HEADER + 31, static_cast<std::uint8_t>(sums.crc));
  return image;
}

}  // namespace kaz::flash_test
