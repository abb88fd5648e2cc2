// JPEG encoder and decoder, the only user of libjpeg.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/picture/picture.h"

namespace kaz::picture {

struct JpegSettings {
  int quality = 85;  // 1..100
  // If true, the encoder computes Huffman tables for each picture. The files are smaller, but encoding is
  // slower.
  bool optimized_tables = true;
};

// Encodes 8-bit samples. Returns Fault::usage if `pixels` is not valid or a side exceeds 65500 px, or
// Fault::failed with libjpeg's message.
Result<std::vector<std::uint8_t>> encode_jpeg(const PixelView& pixels,
                                              const JpegSettings& settings = {});

// Decodes to 8-bit RGB; gray becomes R = G = B. Returns an error for truncated or damaged data, although
// libjpeg only warns and fills in pixels. Pictures without Huffman tables (MJPEG of cameras) are decoded
// with the standard tables.
Decoded decode_jpeg(std::span<const std::uint8_t> bytes, const SizeLimits& limits = {});

}  // namespace kaz::picture
