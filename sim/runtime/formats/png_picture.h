// Pictures as PNG bytes and back, without loss.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/result.hpp"
#include "vision/image/frame.h"

namespace kaz::sim {

// 8-bit RGB. The same picture gives the same bytes with the same libpng and zlib. Quick rather than
// small. Error: `image` has no pixels or their number does not fit its size.
Result<std::vector<std::uint8_t>> encode_png(const vision::Image& image);

// Exactly what was encoded. Error: no PNG, or a damaged one.
Result<vision::Image> decode_png(std::span<const std::uint8_t> bytes);

}  // namespace kaz::sim
