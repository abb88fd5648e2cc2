// Pictures from files: libpng, libjpeg, and the two plain formats of Netpbm.
// SPDX-License-Identifier: Apache-2.0
#include "vision/image/picture_file.h"
#include "shared/base/files.hpp"

#include "shared/base/files.hpp"

#include <png.h>

#include <algorithm>
#include <cctype>
#include <csetjmp>
#include <cstdio>
#include <fstream>
#include <iterator>

#include <jpeglib.h>
// After it: the codes of its messages.
#include <jerror.h>

namespace kaz::vision {
namespace {

constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 26;  // 200 MB: a short file may claim more
constexpr std::size_t kLargestFile = std::size_t{256} << 20;

using Bytes = std::span<const std::uint8_t>;

bool begins_with(Bytes bytes, std::initializer_list<std::uint8_t> magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

bool valid_size(std::uint64_t width, std::uint64_t height) {
  return width >= 1 && height >= 1 && width <= kLargestPictureSide &&
         height <= kLargestPictureSide && width * height <= kMaxPixels;
}

tl::unexpected<Error> bad(const std::string& name, const std::string& what) {
  return fail(Fault::usage, name + ": " + what);
}

tl::unexpected<Error> bad_size(const std::string& name, std::uint64_t width, std::uint64_t height) {
  return bad(name, "is " + std::to_string(width) + " x " + std::to_string(height) +
                       " pixels; sides of 1 to " + std::to_string(kLargestPictureSide) +
                       " and 67 million together can be read");
}

Image blank(std::uint64_t width, std::uint64_t height) {
  return {static_cast<int>(width), static_cast<int>(height),
          std::vector<std::uint8_t>(width * height * 3)};
}

Result<Image> decode_png(Bytes bytes, const std::string& name) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  struct Release {
    png_image& png;
    ~Release() { png_image_free(&png); }
  } const release{png};
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()))
    return bad(name, std::string("is not a valid PNG (") + png.message + ")");
  if (!valid_size(png.width, png.height)) return bad_size(name, png.width, png.height);
  png.format = PNG_FORMAT_RGB;
  Image image = blank(png.width, png.height);
  const png_color black{0, 0, 0};
  if (!png_image_finish_read(&png, &black, image.rgb.data(), 0, nullptr))
    return bad(name, std::string("is not a valid PNG (") + png.message + ")");
  return image;
}

// More than any program writes. Each costs a pass over all pixels, and may take a few bytes alone.
constexpr int kMaxJpegScans = 100;

// libjpeg reports errors by longjmp into header() or pixels(): nothing with a destructor may live in
// their frames. The caller allocates the pixels between the two, by the size that libjpeg itself has
// read; a size found by any other means may differ from what libjpeg then writes.
class JpegDecoder {
 public:
  explicit JpegDecoder(Bytes bytes) : bytes_(bytes) {}
  ~JpegDecoder() { jpeg_destroy_decompress(&jpeg_); }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  // Reads up to the first scan. False: what() is the reason.
  bool header() {
    jpeg_.err = jpeg_std_error(&errors_.manager);
    errors_.manager.error_exit = leave;
    errors_.manager.emit_message = warn;
    if (setjmp(errors_.give_up)) return false;
    jpeg_create_decompress(&jpeg_);
    progress_.progress_monitor = count_scans;
    jpeg_.progress = &progress_;
    jpeg_mem_src(&jpeg_, bytes_.data(), bytes_.size());
    jpeg_read_header(&jpeg_, TRUE);
    return true;
  }
  std::uint64_t width() const { return jpeg_.image_width; }
  std::uint64_t height() const { return jpeg_.image_height; }

  // `rgb` has room for width() * height() * 3 bytes. False: what() is the reason.
  bool pixels(std::span<std::uint8_t> rgb) {
    if (setjmp(errors_.give_up)) return false;
    jpeg_.out_color_space = JCS_RGB;
    jpeg_.dct_method = JDCT_ISLOW;
    jpeg_start_decompress(&jpeg_);
    const std::size_t row_bytes = std::size_t{jpeg_.output_width} * 3;
    if (jpeg_.output_components != 3 || row_bytes * jpeg_.output_height != rgb.size()) {
      std::snprintf(errors_.text, sizeof errors_.text, "its pixels do not fit its size");
      return false;
    }
    while (jpeg_.output_scanline < jpeg_.output_height) {
      JSAMPROW row = rgb.data() + jpeg_.output_scanline * row_bytes;
      jpeg_read_scanlines(&jpeg_, &row, 1);
    }
    jpeg_finish_decompress(&jpeg_);
    return true;
  }
  const char* what() const { return errors_.text; }

 private:
  struct Errors {
    jpeg_error_mgr manager;  // first: libjpeg knows only of it
    std::jmp_buf give_up;
    char text[JMSG_LENGTH_MAX];
  };

  [[noreturn]] static void leave(j_common_ptr common) {
    auto* mine = reinterpret_cast<Errors*>(common->err);
    mine->manager.format_message(common, mine->text);
    std::longjmp(mine->give_up, 1);
  }
  // A warning (level -1) means that data are damaged or missing and were made up. Some cameras write
  // a few bytes too many between two parts: those may be there.
  static void warn(j_common_ptr common, int level) {
    const int code = common->err->msg_code;
    if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_JFIF_MAJOR) leave(common);
  }
  static void count_scans(j_common_ptr common) {
    if (reinterpret_cast<j_decompress_ptr>(common)->input_scan_number <= kMaxJpegScans) return;
    auto* mine = reinterpret_cast<Errors*>(common->err);
    std::snprintf(mine->text, sizeof mine->text, "more than %d scans", kMaxJpegScans);
    std::longjmp(mine->give_up, 1);
  }

  Bytes bytes_;
  Errors errors_{};
  jpeg_progress_mgr progress_{};
  jpeg_decompress_struct jpeg_{};
};

Result<Image> decode_jpeg(Bytes bytes, const std::string& name) {
  JpegDecoder decoder(bytes);
  const auto invalid = [&] {
    return bad(name, std::string("is not a valid JPEG (") + decoder.what() + ")");
  };
  if (!decoder.header()) return invalid();
  if (!valid_size(decoder.width(), decoder.height()))
    return bad_size(name, decoder.width(), decoder.height());
  Image image = blank(decoder.width(), decoder.height());
  if (!decoder.pixels(image.rgb)) return invalid();
  return image;
}

// P5 (grey) and P6 (RGB), 8 bits.
Result<Image> decode_netpbm(Bytes bytes, const std::string& name) {
  std::size_t at = 2;
  const auto number = [&]() -> std::uint64_t {
    while (at < bytes.size() && (std::isspace(bytes[at]) || bytes[at] == '#')) {
      if (bytes[at] == '#') {
        while (at < bytes.size() && bytes[at] != '\n') ++at;
      } else {
        ++at;
      }
    }
    std::uint64_t value = 0;
    while (at < bytes.size() && std::isdigit(bytes[at]) && value < 1000000)
      value = value * 10 + (bytes[at++] - '0');
    return value;
  };
  const std::uint64_t width = number(), height = number(), greatest = number();
  if (greatest != 255) return bad(name, "is a PGM or PPM of other than 8 bits");
  if (!valid_size(width, height)) return bad_size(name, width, height);
  ++at;
  const std::size_t channels = bytes[1] == '6' ? 3 : 1;
  const std::size_t wanted = width * height * channels;
  if (at > bytes.size() || bytes.size() - at < wanted) return bad(name, "ends within the picture");
  Image image = blank(width, height);
  const Bytes data = bytes.subspan(at, wanted);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = data[channels == 3 ? i : i / 3];
  return image;
}

}  // namespace

Result<Image> decode_picture(Bytes bytes, const std::string& name) {
  if (bytes.empty()) return bad(name, "is empty");
  if (begins_with(bytes, {0x89, 'P', 'N', 'G'})) return decode_png(bytes, name);
  if (begins_with(bytes, {0xFF, 0xD8})) return decode_jpeg(bytes, name);
  if (begins_with(bytes, {'P', '5'}) || begins_with(bytes, {'P', '6'}))
    return decode_netpbm(bytes, name);
  return bad(name, "is no picture that can be read: PNG, JPEG, PGM and PPM can");
}

Result<Image> read_picture(const std::string& path) {
  const auto bytes =
      KAZ_TRY(read_whole_file(path, kLargestFile, "give a picture: PNG, JPEG, PGM or PPM"));
  return decode_picture({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, path);
}

bool looks_like_picture(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  char first[3] = {};
  in.read(first, sizeof first);
  if (!in) return false;
  const auto begins = [&](std::string_view with) {
    return std::string_view(first, sizeof first).starts_with(with);
  };
  return begins("\x89PN") || begins("\xff\xd8\xff") || begins("P6") || begins("P5");
}

}  // namespace kaz::vision
