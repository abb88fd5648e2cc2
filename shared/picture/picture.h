// Pixels in memory, as the PNG and JPEG codecs take and return them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::picture {

// Pixels of somebody else: rows from top to bottom, channels interleaved, no padding.
struct PixelView {
  int width = 0, height = 0;
  int channels = 3;  // 1: grey, 3: RGB
  int bits = 8;      // per sample, 8 or 16; of 16 the high byte comes first
  std::span<const std::uint8_t> samples;
};

inline std::size_t bytes_per_row(const PixelView& pixels) {
  return static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.channels) *
         static_cast<std::size_t>(pixels.bits / 8);
}

// Neither empty nor of another number of bytes than its size needs; channels and bits as above.
inline bool valid(const PixelView& pixels) {
  return pixels.width > 0 && pixels.height > 0 && (pixels.channels == 1 || pixels.channels == 3) &&
         (pixels.bits == 8 || pixels.bits == 16) &&
         pixels.samples.size() == bytes_per_row(pixels) * static_cast<std::size_t>(pixels.height);
}

// 8-bit RGB, rows from top to bottom, no padding.
struct RgbPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

// Sizes that a decoder accepts. Checked on the header, before memory for pixels is allocated: a file of a
// few bytes may claim any size.
inline constexpr int kMaxSide = 16384;                               // px
inline constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 26;  // 200 MB of RGB
struct SizeLimits {
  int max_side = kMaxSide;  // px
  std::uint64_t max_pixels = kMaxPixels;
};

inline bool within(const SizeLimits& limits, std::uint64_t width, std::uint64_t height) {
  const auto side = static_cast<std::uint64_t>(limits.max_side);
  return width >= 1 && height >= 1 && width <= side && height <= side &&
         width * height <= limits.max_pixels;
}

// Why bytes could not be decoded. No sentence yet: the caller knows the file's name and its limits.
struct DecodeError {
  enum class Kind {
    invalid,  // not of the format, or ends early; `reason` is the library's
    damaged,  // complete, but the library warned; `reason` is its warning
    size      // out of the limits; `width` and `height` as the header claims
  };
  Kind kind = Kind::invalid;
  std::string reason;
  std::uint64_t width = 0, height = 0;  // px
};

using Decoded = tl::expected<RgbPicture, DecodeError>;

}  // namespace kaz::picture
