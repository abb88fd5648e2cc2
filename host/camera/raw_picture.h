// Converts camera pictures to RGB: YUYV, RGB24, GREY and MJPEG, as V4L2 defines them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "vision/image/frame.h"

namespace kaz::host {

enum class PixelFormat { yuyv, rgb24, mjpeg, grey };

// Returns "yuyv", "rgb24", "mjpeg" or "grey".
std::string_view pixel_format_name(PixelFormat format);
std::optional<PixelFormat> pixel_format_by_name(std::string_view name);

// Encoding of YUYV. The weights of red and blue in Y are those of ITU-R BT.601 (most cameras) or BT.709.
// Limited range: Y from 16 to 235, color differences from 16 to 240. Full range: Y and color differences from
// 0 to 255.
struct YuvMeaning {
  bool bt709 = false;
  bool full_range = false;
};

struct RawLayout {
  PixelFormat format = PixelFormat::yuyv;
  int width = 0, height = 0;       // px; for yuyv, the width must be even
  std::size_t bytes_per_line = 0;  // ignored for mjpeg
  YuvMeaning yuv;
};

// Converts a picture to RGB. Gray becomes R = G = B. Most cameras omit the Huffman tables from MJPEG
// pictures; the tables of the JPEG standard (annex K.3) then replace the missing tables. Fails if bytes are
// missing or damaged, or if a JPEG has another size.
Result<void> convert_picture(std::span<const std::uint8_t> bytes, const RawLayout& layout,
                             vision::Image& image);

}  // namespace kaz::host
