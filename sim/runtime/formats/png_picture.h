// Encodes and decodes the PNG pictures of recordings.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/result.hpp"
#include "vision/image/frame.h"

namespace kaz::sim {

// Encodes 8-bit RGB with low compression for speed. Deterministic for the same libpng and zlib. Fails if
// `image` is empty or its number of pixels does not match its size.
Result<std::vector<std::uint8_t>> encode_png(const vision::Image& image);

// Decodes a PNG. Fails if it is not a PNG, is damaged, or has a side above 8192 px.
Result<vision::Image> decode_png(std::span<const std::uint8_t> bytes);

}  // namespace kaz::sim
