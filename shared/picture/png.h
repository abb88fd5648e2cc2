// PNG encoder and decoder, the only user of libpng.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/picture/picture.h"

namespace kaz::picture {

struct PngSettings {
  int level = 6;  // zlib level: 0 does not compress, 9 compresses most
  // If true, libpng selects a filter for each row. Without filters, encoding is faster, but files are larger.
  bool filters = true;
  bool srgb = false;               // true: the samples are sRGB, and the file gets the chunk sRGB
  const char* software = nullptr;  // if not null: value of the text chunk "Software"
};

// Encodes a picture. With the same versions of libpng and zlib, equal pixels and settings give equal bytes.
// 16-bit samples may represent any quantity, so the samples are stored unchanged, without a gamma chunk.
// If `pixels` is not valid, returns Fault::usage. If libpng fails, returns Fault::failed with libpng's
// message.
Result<std::vector<std::uint8_t>> encode_png(const PixelView& pixels,
                                             const PngSettings& settings = {});

// Reaction to libpng's warnings, for example to the warning about a wrong checksum after the last pixel.
enum class PngWarnings { ignored, are_errors };

// Decodes any PNG to 8-bit RGB, as OpenCV's imread does. Gray becomes R = G = B, and 16-bit samples lose
// their low byte. Colors are the stored ones. Alpha, transparent colors and gamma chunks are ignored.
Decoded decode_png(std::span<const std::uint8_t> bytes, const SizeLimits& limits = {},
                   PngWarnings warnings = PngWarnings::ignored);

}  // namespace kaz::picture
