// PNG encoder and decoder. The only user of libpng.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/picture/picture.h"

namespace kaz::picture {

struct PngSettings {
  int level = 6;        // of zlib: 0 stores, 9 compresses most
  bool filters = true;  // libpng selects one per row; without them: faster, larger files
  bool srgb = false;    // adds the sRGB chunk (and gAMA and cHRM for old readers): samples are sRGB
  const char* software = nullptr;  // what has made the picture, as a text in the file
};

// The same bytes for the same pixels and settings, as long as libpng and zlib are the same. 16-bit samples
// are stored as they are, without a gamma chunk: they may be any quantity.
// Errors: usage if `pixels` are not valid; failed with libpng's message.
Result<std::vector<std::uint8_t>> encode_png(const PixelView& pixels,
                                             const PngSettings& settings = {});

// libpng warns only, and returns the pixels, where e.g. the checksum behind the last pixel is wrong.
enum class PngWarnings { ignored, are_errors };

// Any PNG as 8-bit RGB: grey becomes equal parts, 16 bits become 8, transparent pixels are composed on black.
Decoded decode_png(std::span<const std::uint8_t> bytes, const SizeLimits& limits = {},
                   PngWarnings warnings = PngWarnings::ignored);

}  // namespace kaz::picture
