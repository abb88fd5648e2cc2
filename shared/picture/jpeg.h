// JPEG encoder and decoder. The only user of libjpeg.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/picture/picture.h"

namespace kaz::picture {

struct JpegSettings {
  int quality = 85;  // 1..100
  bool optimized_tables =
      true;  // Huffman tables of the picture instead of the standard's: smaller, slower
};

// Samples of 8 bits. Errors: usage if `pixels` are not valid or a side exceeds 65500 px; failed with
// libjpeg's message.
Result<std::vector<std::uint8_t>> encode_jpeg(const PixelView& pixels,
                                              const JpegSettings& settings = {});

// Grey becomes equal parts. Strict: data that end early or are damaged are an error, where libjpeg warns and
// makes up the rest. Without Huffman tables (MJPEG of cameras) those of the standard are used.
Decoded decode_jpeg(std::span<const std::uint8_t> bytes, const SizeLimits& limits = {});

}  // namespace kaz::picture
