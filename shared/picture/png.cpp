// libpng, into and from memory.
// SPDX-License-Identifier: Apache-2.0
#include "shared/picture/png.h"

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <new>
#include <string>
#include <utility>

#include <png.h>

namespace kaz::picture {
namespace {

// The simplified interface of libpng is not used. Its writer has only two compression levels, and its writer
// and reader take 16-bit samples as linear light. Its reader also blends or converts colors.
//
// libpng reports errors by longjmp into write(), header() or pixels(). No object with a destructor may live
// in these frames.
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

// The caller allocates the pixels between header() and pixels().
class PngDecoder {
 public:
  explicit PngDecoder(std::span<const std::uint8_t> bytes) : rest_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, leave, warn);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~PngDecoder() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  // Reads up to the first pixels. If it returns false, what() is the reason.
  bool header() {
    if (info_ == nullptr) return false;
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_read_fn(png_, this, copy);
    png_set_benign_errors(png_, 1);  // as warnings
    // Skips all chunks but IHDR, PLTE, tRNS, IDAT and IEND. A skipped chunk is never uncompressed.
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_read_info(png_, info_);
    width_ = png_get_image_width(png_, info_);
    height_ = png_get_image_height(png_, info_);
    return true;
  }
  std::uint64_t width() const { return width_; }
  std::uint64_t height() const { return height_; }

  // `rgb` has room for width() * height() * 3 bytes. If it returns false, what() is the reason.
  bool pixels(std::span<std::uint8_t> rgb) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    const int type = png_get_color_type(png_, info_);
    png_set_strip_16(png_);
    if (type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png_);
    if ((type & PNG_COLOR_MASK_COLOR) == 0) {
      if (png_get_bit_depth(png_, info_) < 8) png_set_expand_gray_1_2_4_to_8(png_);
      png_set_gray_to_rgb(png_);
    }
    png_set_strip_alpha(png_);
    const int passes = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    const std::size_t row_bytes = png_get_rowbytes(png_, info_);
    if (row_bytes != width_ * 3 || row_bytes * height_ != rgb.size())
      png_error(png_, "its pixels do not match its size");
    for (int pass = 0; pass < passes; ++pass) {
      for (std::size_t y = 0; y < height_; ++y)
        png_read_row(png_, rgb.data() + y * row_bytes, nullptr);
    }
    return true;
  }
  bool warned() const { return warned_; }
  // The error, or else the first warning.
  const char* what() const { return text_; }

 private:
  [[noreturn]] static void leave(png_structp png, png_const_charp message) {
    auto* mine = static_cast<PngDecoder*>(png_get_error_ptr(png));
    std::snprintf(mine->text_, sizeof mine->text_, "%s", message);
    png_longjmp(png, 1);
  }
  static void warn(png_structp png, png_const_charp message) {
    auto* mine = static_cast<PngDecoder*>(png_get_error_ptr(png));
    if (!mine->warned_) std::snprintf(mine->text_, sizeof mine->text_, "%s", message);
    mine->warned_ = true;
  }
  static void copy(png_structp png, png_bytep to, png_size_t size) {
    auto& rest = static_cast<PngDecoder*>(png_get_io_ptr(png))->rest_;
    if (rest.size() < size) png_error(png, "the file ends within the picture");
    std::copy_n(rest.begin(), size, to);
    rest = rest.subspan(size);
  }

  std::span<const std::uint8_t> rest_;
  char text_[128] = "out of memory";
  bool warned_ = false;
  std::uint64_t width_ = 0, height_ = 0;
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
  PngDecoder decoder(bytes);
  const auto error = [&](DecodeError::Kind kind) {
    return tl::unexpected(DecodeError{kind, decoder.what(), decoder.width(), decoder.height()});
  };
  if (!decoder.header()) return error(DecodeError::Kind::invalid);
  if (!within(limits, decoder.width(), decoder.height())) return error(DecodeError::Kind::size);
  Image picture{static_cast<int>(decoder.width()), static_cast<int>(decoder.height()), {}};
  picture.rgb.resize(decoder.width() * decoder.height() * 3);
  if (!decoder.pixels(picture.rgb)) return error(DecodeError::Kind::invalid);
  if (warnings == PngWarnings::are_errors && decoder.warned())
    return error(DecodeError::Kind::damaged);
  return picture;
}

}  // namespace kaz::picture
