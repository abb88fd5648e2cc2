// libpng: its simplified interface reads, its full one writes.
// SPDX-License-Identifier: Apache-2.0
#include "shared/picture/png.h"

#include <csetjmp>
#include <cstdio>
#include <new>
#include <string>
#include <utility>

#include <png.h>

namespace kaz::picture {
namespace {

// The simplified interface cannot write either: it has two compression levels only, and takes 16 bits as
// linear light, for which it writes a gamma chunk.
//
// libpng reports errors by longjmp into write(): nothing with a destructor may live in its frame.
class PngEncoder {
 public:
  PngEncoder() {
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, leave, ignore);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~PngEncoder() { png_destroy_write_struct(&png_, &info_); }
  PngEncoder(const PngEncoder&) = delete;
  PngEncoder& operator=(const PngEncoder&) = delete;

  // False: what() is the reason.
  bool write(const PixelView& pixels, const PngSettings& settings) {
    if (info_ == nullptr) return false;
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_write_fn(png_, this, append, flush);
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(pixels.width),
                 static_cast<png_uint_32>(pixels.height), pixels.bits,
                 pixels.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (settings.srgb) png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
    if (settings.software != nullptr) {
      png_text text{};
      text.compression = PNG_TEXT_COMPRESSION_NONE;
      text.key = const_cast<char*>("Software");
      text.text = const_cast<char*>(settings.software);
      png_set_text(png_, info_, &text, 1);
    }
    png_set_compression_level(png_, settings.level);
    png_write_info(png_, info_);
    // After the header, whose writing resets a lack of filters to libpng's default.
    if (!settings.filters) png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_NO_FILTERS);
    const std::size_t row_bytes = bytes_per_row(pixels);
    for (int y = 0; y < pixels.height; ++y)
      png_write_row(png_, pixels.samples.data() + static_cast<std::size_t>(y) * row_bytes);
    png_write_end(png_, nullptr);
    return true;
  }
  const char* what() const { return text_; }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  [[noreturn]] static void leave(png_structp png, png_const_charp message) {
    auto* mine = static_cast<PngEncoder*>(png_get_error_ptr(png));
    std::snprintf(mine->text_, sizeof mine->text_, "%s", message);
    png_longjmp(png, 1);
  }
  static void ignore(png_structp, png_const_charp) {}
  static void flush(png_structp) {}
  // No exception may pass through libpng's frames.
  static void append(png_structp png, png_bytep data, png_size_t size) {
    auto& bytes = static_cast<PngEncoder*>(png_get_io_ptr(png))->bytes_;
    bool enough = true;
    try {
      bytes.insert(bytes.end(), data, data + size);
    } catch (const std::bad_alloc&) {
      enough = false;
    }
    if (!enough) png_error(png, "out of memory");
  }

  char text_[128] = "out of memory";
  std::vector<std::uint8_t> bytes_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

Result<std::vector<std::uint8_t>> encode_png(const PixelView& pixels, const PngSettings& settings) {
  if (!valid(pixels))
    return fail(Fault::usage, "invalid picture: " + std::to_string(pixels.width) + " x " +
                                  std::to_string(pixels.height) + " pixels with " +
                                  std::to_string(pixels.samples.size()) + " bytes");
  PngEncoder encoder;
  if (!encoder.write(pixels, settings))
    return fail(Fault::failed, std::string("cannot encode the picture as PNG: ") + encoder.what());
  return encoder.take();
}

Decoded decode_png(std::span<const std::uint8_t> bytes, const SizeLimits& limits,
                   PngWarnings warnings) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  struct Release {
    png_image& png;
    ~Release() { png_image_free(&png); }
  } const release{png};
  const auto error = [&](DecodeError::Kind kind) {
    return tl::unexpected(DecodeError{kind, png.message, png.width, png.height});
  };
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()))
    return error(DecodeError::Kind::invalid);
  if (!within(limits, png.width, png.height)) return error(DecodeError::Kind::size);
  png.format = PNG_FORMAT_RGB;
  Image picture{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  picture.rgb.resize(PNG_IMAGE_SIZE(png));
  const png_color black{0, 0, 0};
  if (!png_image_finish_read(&png, &black, picture.rgb.data(), 0, nullptr))
    return error(DecodeError::Kind::invalid);
  if (warnings == PngWarnings::are_errors && png.warning_or_error != 0)
    return error(DecodeError::Kind::damaged);
  return picture;
}

}  // namespace kaz::picture
