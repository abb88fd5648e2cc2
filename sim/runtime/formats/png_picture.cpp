// PNG of recordings: shared/picture with the settings and limits of recordings.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/png_picture.h"

#include <string>
#include <utility>

#include "shared/picture/png.h"

namespace kaz::sim {
namespace {

// Part of the format: recordings of the same seed are the same bytes.
constexpr picture::PngSettings kPngSettings{.level = 3, .filters = false, .srgb = true};
constexpr picture::SizeLimits kPngLimits{.max_side = 8192};

std::string reason_text(const picture::DecodeError& error) {
  using Kind = picture::DecodeError::Kind;
  if (error.kind == Kind::size)
    return "a PNG of " + std::to_string(error.width) + " x " + std::to_string(error.height) +
           " pixels is not an eye's picture";
  if (error.kind == Kind::damaged) return "a picture is damaged: " + error.reason;
  return "a picture cannot be read as PNG: " + error.reason;
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_png(const vision::Image& image) {
  return picture::encode_png({.width = image.width, .height = image.height, .samples = image.rgb},
                             kPngSettings);
}

Result<vision::Image> decode_png(std::span<const std::uint8_t> bytes) {
  auto decoded = picture::decode_png(bytes, kPngLimits, picture::PngWarnings::are_errors);
  if (!decoded) return fail(Fault::failed, reason_text(decoded.error()));
  return *std::move(decoded);
}

}  // namespace kaz::sim
