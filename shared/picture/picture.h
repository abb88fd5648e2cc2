// Pixels in memory, for the PNG and JPEG codecs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::picture {

// Non-owning view of pixels: rows from top to bottom, channels interleaved, no padding.
struct PixelView {
  int width = 0, height = 0;
  int channels = 3;  // 1: gray, 3: RGB
  int bits = 8;      // bits per sample: 8, or 16 with the high byte first
  std::span<const std::uint8_t> samples;
};

inline std::size_t bytes_per_row(const PixelView& pixels) {
  return static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.channels) *
         static_cast<std::size_t>(pixels.bits / 8);
}

// Returns whether the picture is valid: not empty, with supported channels and bits, and with as many bytes
// as the size requires.
inline bool valid(const PixelView& pixels) {
  return pixels.width > 0 && pixels.height > 0 && (pixels.channels == 1 || pixels.channels == 3) &&
         (pixels.bits == 8 || pixels.bits == 16) &&
         pixels.samples.size() == bytes_per_row(pixels) * static_cast<std::size_t>(pixels.height);
}

// 8-bit RGB, rows from top to bottom, no padding.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

// Limits of the sizes that a decoder accepts. Even a small file can state any picture size in its header. So
// decoders check the header before they allocate memory for pixels.
inline constexpr int kMaxSide = 16384;                               // px
inline constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 26;  // 200 MB of RGB
struct SizeLimits {
  int max_side = kMaxSide;  // px
  std::uint64_t max_pixels = kMaxPixels;
};

// Returns whether a picture of this size (px) is within the limits and not empty.
inline bool within(const SizeLimits& limits, std::uint64_t width, std::uint64_t height) {
  const auto side = static_cast<std::uint64_t>(limits.max_side);
  return width >= 1 && height >= 1 && width <= side && height <= side &&
         width * height <= limits.max_pixels;
}

// Cause of a decoding failure. The caller composes the error message from this cause, the file's name and the
// limits.
struct DecodeError {
  enum class Kind {
    invalid,  // wrong format or truncated; `reason` is the library's message
    damaged,  // complete, but the library warned; `reason` is the library's warning
    size      // outside the limits; `width` and `height` are from the header
  };
  Kind kind = Kind::invalid;
  std::string reason;
  std::uint64_t width = 0, height = 0;  // px
};

using Decoded = tl::expected<Image, DecodeError>;

}  // namespace kaz::picture
