// libpng's simplified interface: no long jumps, errors as text.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/png_picture.h"

#include <string>

#include <png.h>

namespace kaz::sim {
namespace {

constexpr png_uint_32 largest_side = 8192;  // px

png_image header() {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  return png;
}

tl::unexpected<Error> refused(const char* what, const png_image& png) {
  return fail(Fault::failed, std::string(what) + ": " + png.message);
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_png(const vision::Image& image) {
  const auto pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.width <= 0 || image.height <= 0 || image.rgb.size() != 3 * pixels)
    return fail(Fault::usage, "a picture of " + std::to_string(image.width) + " x " +
                                  std::to_string(image.height) + " pixels with " +
                                  std::to_string(image.rgb.size()) + " bytes is none");
  png_image png = header();
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0)
    return refused("a picture cannot be made a PNG", png);
  bytes.resize(size);
  return bytes;
}

Result<vision::Image> decode_png(std::span<const std::uint8_t> bytes) {
  png_image png = header();
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0)
    return refused("a picture cannot be read as PNG", png);
  vision::Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  if (png.width > largest_side || png.height > largest_side) {
    png_image_free(&png);
    return fail(Fault::failed, "a PNG of " + std::to_string(image.width) + " x " +
                                   std::to_string(image.height) + " pixels is no eye's picture");
  }
  png.format = PNG_FORMAT_RGB;
  image.rgb.resize(PNG_IMAGE_SIZE(png));
  if (png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr) == 0)
    return refused("a picture cannot be read as PNG", png);
  // libpng only warns about a wrong checksum at the end, i.e. damaged pixels.
  if (PNG_IMAGE_FAILED(png) || png.warning_or_error != 0)
    return refused("a picture is damaged", png);
  return image;
}

}  // namespace kaz::sim
