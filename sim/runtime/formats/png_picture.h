// Encodes and decodes the PNG pictures of recordings.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/result.hpp"
#include "vision/image/frame.h"

namespace kaz::sim {

// Encodes 8-bit RGB with low compression for speed. For the same picture, the same versions of libpng and
// zlib always produce the same bytes. Fails if `image` is empty, or if the number of pixels does not match
// the width and the height.
Result<std::vector<std::uint8_t>> encode_png(const vision::Image& image);

// Decodes a PNG. Fails if the bytes are not a PNG or are damaged, or if a side of the picture is longer than
// 8192 px.
Result<vision::Image> decode_png(std::span<const std::uint8_t> bytes);

}  // namespace kaz::sim
