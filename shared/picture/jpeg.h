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

// Encodes 8-bit samples. If `pixels` is not valid, has 16-bit samples or has a side of more than 65500 px,
// returns Fault::usage. If libjpeg fails, returns Fault::failed with libjpeg's message.
Result<std::vector<std::uint8_t>> encode_jpeg(const PixelView& pixels,
                                              const JpegSettings& settings = {});

// Decodes to 8-bit RGB; gray becomes R = G = B. If libjpeg warns about truncated or damaged data, returns an
// error. Pictures without Huffman tables (MJPEG of cameras) are decoded with the standard tables. A picture
// with an EXIF orientation is turned upright, as OpenCV's imread does it.
Decoded decode_jpeg(std::span<const std::uint8_t> bytes, const SizeLimits& limits = {});

}  // namespace kaz::picture
