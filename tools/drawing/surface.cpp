// Pixels to Cairo and back, PNG files.
// SPDX-License-Identifier: Apache-2.0
#include "tools/drawing/surface.h"

#include <algorithm>

#include "shared/picture/png.h"

// Leaks of libraries, not ours, that the leak checker would report: Mesa keeps 160 bytes of each
// context, fontconfig its patterns. Weak, for another library of ours may bring the same list.
#if defined(__SANITIZE_ADDRESS__)
extern "C" const char* __lsan_default_suppressions();
extern "C" [[gnu::weak]] const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\nleak:libfontconfig.so\n";
}
#endif

namespace kaz::figure {

Surface blank_surface(int width, int height, Color color) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  const Context c(cairo_create(surface.get()));
  set_color(c.get(), color);
  cairo_paint(c.get());
  return surface;
}

Surface surface_from(const Image& image) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height));
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) return surface;
  cairo_surface_flush(surface.get());
  unsigned char* data = cairo_image_surface_get_data(surface.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  const auto width = static_cast<std::size_t>(image.width),
             height = static_cast<std::size_t>(image.height);
  for (std::size_t y = 0; y < height; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(data + y * stride);
    const std::uint8_t* from = &image.rgb[y * width * 3];
    for (std::size_t x = 0; x < width; ++x, from += 3) {
      row[x] = static_cast<std::uint32_t>(from[0]) << 16 |
               static_cast<std::uint32_t>(from[1]) << 8 | from[2];
    }
  }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

Image image_from(cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  Image image;
  image.width = cairo_image_surface_get_width(surface);
  image.height = cairo_image_surface_get_height(surface);
  const auto width = static_cast<std::size_t>(image.width),
             height = static_cast<std::size_t>(image.height);
  image.rgb.resize(width * height * 3);
  const unsigned char* data = cairo_image_surface_get_data(surface);
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface));
  std::uint8_t* to = image.rgb.data();
  for (std::size_t y = 0; y < height; ++y) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(data + y * stride);
    for (std::size_t x = 0; x < width; ++x) {
      for (const unsigned shift : {16U, 8U, 0U}) *to++ = static_cast<std::uint8_t>(row[x] >> shift);
    }
  }
  return image;
}

void set_font(cairo_t* c, double size_px, bool bold) {
  cairo_select_font_face(c, kFont, CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, size_px);
}

namespace {

tl::unexpected<Error> cannot_encode(const std::string& path, const std::string& why) {
  return fail(Fault::environment,
              path + ": cannot encode the picture (" + why + "): check the free memory");
}

Result<void> write_encoded_png(const std::string& path, const Image& image) {
  const auto bytes =
      picture::encode_png({.width = image.width, .height = image.height, .samples = image.rgb});
  if (!bytes) return cannot_encode(path, bytes.error().message);
  return write_file(path, *bytes);
}

}  // namespace

// Cairo's own writer would be a second way to make a PNG.
Result<void> write_surface_png(const std::string& path, cairo_surface_t* surface) {
  const cairo_status_t status = cairo_surface_status(surface);
  if (status != CAIRO_STATUS_SUCCESS) return cannot_encode(path, cairo_status_to_string(status));
  return write_encoded_png(path, image_from(surface));
}

Result<void> write_png(const std::string& path, const Image& image) {
  constexpr int kLargestSide = 32767;  // of a Cairo surface, on which pictures are drawn
  const auto pixels = static_cast<std::size_t>(std::max(image.width, 0)) *
                      static_cast<std::size_t>(std::max(image.height, 0));
  if (pixels == 0 || image.rgb.size() != 3 * pixels ||
      std::max(image.width, image.height) > kLargestSide) {
    return fail(Fault::usage, path + ": cannot write an image of " + std::to_string(image.width) +
                                  " x " + std::to_string(image.height) + " pixels and " +
                                  std::to_string(image.rgb.size()) +
                                  " bytes: it must have 3 bytes per pixel and sides of 1 to 32767");
  }
  return write_encoded_png(path, image);
}

}  // namespace kaz::figure
