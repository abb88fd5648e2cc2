// Encodes and decodes PNG pictures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/result.hpp"
#include "vision/image/frame.h"

namespace kaz::sim {

// 8-bit RGB, low compression for speed. Deterministic for the same libpng and zlib. Error: `image` is empty
// or its number of pixels does not match its size.
Result<std::vector<std::uint8_t>> encode_png(const vision::Image& image);

// The encoded pixels. Error: not a PNG, or a damaged one.
Result<vision::Image> decode_png(std::span<const std::uint8_t> bytes);

}  // namespace kaz::sim
