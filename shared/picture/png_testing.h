// Test helper: reads the stored samples of a PNG. decode_png would convert the samples to 8-bit RGB.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <png.h>

#include "shared/picture/picture.h"

namespace kaz::picture {

struct StoredPng {
  int width = 0, height = 0, channels = 0, bits = 0;
  bool srgb = false, gamma = false;   // whether the chunks sRGB and gAMA are present
  std::vector<std::uint8_t> samples;  // layout as in PixelView
};

// Returns the stored samples, or nullopt if libpng reports an error.
inline std::optional<StoredPng> stored_png(std::span<const std::uint8_t> bytes) {
  struct Reader {
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    std::span<const std::uint8_t> rest;

    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
    // libpng reports errors by longjmp into this frame, so no object here may have a destructor.
    bool read() {
      if (setjmp(png_jmpbuf(png)) != 0) return false;
      png_set_read_fn(png, this, [](png_structp p, png_bytep to, png_size_t size) {
        auto& from = static_cast<Reader*>(png_get_io_ptr(p))->rest;
        if (from.size() < size) png_error(p, "ends early");
        std::copy_n(from.begin(), size, to);
        from = from.subspan(size);
      });
      png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
      return true;
    }
  } reader;
  reader.rest = bytes;
  if (!reader.read()) return std::nullopt;
  StoredPng stored;
  stored.width = static_cast<int>(png_get_image_width(reader.png, reader.info));
  stored.height = static_cast<int>(png_get_image_height(reader.png, reader.info));
  stored.channels = png_get_channels(reader.png, reader.info);
  stored.bits = png_get_bit_depth(reader.png, reader.info);
  stored.srgb = png_get_valid(reader.png, reader.info, PNG_INFO_sRGB) != 0;
  stored.gamma = png_get_valid(reader.png, reader.info, PNG_INFO_gAMA) != 0;
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  png_bytepp rows = png_get_rows(reader.png, reader.info);
  for (int y = 0; y < stored.height; ++y)
    stored.samples.insert(stored.samples.end(), rows[y], rows[y] + row_bytes);
  return stored;
}

}  // namespace kaz::picture
