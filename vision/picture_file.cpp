// Pictures from files: libpng, libjpeg, and the two plain formats of Netpbm.
// SPDX-License-Identifier: Apache-2.0
#include "vision/picture_file.h"

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

constexpr std::uint64_t kMostPixels = std::uint64_t{1}
                                      << 26;  // 200 MB: a short file may claim more
constexpr std::size_t kLargestFile = std::size_t{256} << 20;

using Bytes = std::span<const std::uint8_t>;

bool begins_with(Bytes bytes, std::initializer_list<std::uint8_t> magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

bool sound_size(std::uint64_t width, std::uint64_t height) {
  return width >= 1 && height >= 1 && width <= kLargestPictureSide &&
         height <= kLargestPictureSide && width * height <= kMostPixels;
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
    return bad(name, std::string("is no sound PNG (") + png.message + ")");
  if (!sound_size(png.width, png.height)) return bad_size(name, png.width, png.height);
  png.format = PNG_FORMAT_RGB;
  Image image = blank(png.width, png.height);
  const png_color black{0, 0, 0};
  if (!png_image_finish_read(&png, &black, image.rgb.data(), 0, nullptr))
    return bad(name, std::string("is no sound PNG (") + png.message + ")");
  return image;
}

struct JpegErrors {
  jpeg_error_mgr manager;  // first: libjpeg knows only of it
  std::jmp_buf give_up;
  char text[JMSG_LENGTH_MAX];
};

// libjpeg is C: it leaves by longjmp. Nothing with a destructor lives in this function.
bool decompress(Bytes bytes, JpegErrors& errors, Image& image, bool& size_is_sound) {
  jpeg_decompress_struct jpeg;
  jpeg.err = jpeg_std_error(&errors.manager);
  const auto leave = [](j_common_ptr common) {
    auto* mine = reinterpret_cast<JpegErrors*>(common->err);
    mine->manager.format_message(common, mine->text);
    std::longjmp(mine->give_up, 1);
  };
  errors.manager.error_exit = leave;
  // A warning (level -1) says that data are damaged or missing and were made up. Some cameras write
  // a few bytes too many between two parts: those may be there.
  errors.manager.emit_message = [](j_common_ptr common, int level) {
    const int code = common->err->msg_code;
    if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_JFIF_MAJOR)
      common->err->error_exit(common);
  };
  if (setjmp(errors.give_up)) {
    jpeg_destroy_decompress(&jpeg);
    return false;
  }
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  size_is_sound = sound_size(jpeg.image_width, jpeg.image_height);
  if (size_is_sound) {
    jpeg.out_color_space = JCS_RGB;
    jpeg.dct_method = JDCT_ISLOW;
    jpeg_start_decompress(&jpeg);
    while (jpeg.output_scanline < jpeg.output_height) {
      JSAMPROW row = image.rgb.data() + std::size_t{jpeg.output_scanline} * jpeg.output_width * 3;
      jpeg_read_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_decompress(&jpeg);
  }
  jpeg_destroy_decompress(&jpeg);
  return true;
}

// Width and height from the first start-of-frame marker; libjpeg then checks them against the rest.
bool jpeg_size(Bytes bytes, std::uint64_t& width, std::uint64_t& height) {
  std::size_t at = 2;
  while (at + 9 < bytes.size()) {
    if (bytes[at] != 0xFF) return false;
    const int marker = bytes[at + 1];
    if (marker == 0xFF) {  // fill
      ++at;
      continue;
    }
    if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) {
      height = static_cast<std::uint64_t>(bytes[at + 5] << 8 | bytes[at + 6]);
      width = static_cast<std::uint64_t>(bytes[at + 7] << 8 | bytes[at + 8]);
      return true;
    }
    if (marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8)) {  // without a length
      at += 2;
      continue;
    }
    at += 2 + static_cast<std::size_t>(bytes[at + 2] << 8 | bytes[at + 3]);
  }
  return false;
}

Result<Image> decode_jpeg(Bytes bytes, const std::string& name) {
  std::uint64_t width = 0, height = 0;
  if (!jpeg_size(bytes, width, height))
    return bad(name, "is no sound JPEG (it ends or breaks off before the picture)");
  if (!sound_size(width, height)) return bad_size(name, width, height);
  Image image = blank(width, height);
  JpegErrors errors{};
  bool size_is_sound = false;
  if (!decompress(bytes, errors, image, size_is_sound))
    return bad(name, std::string("is no sound JPEG (") + errors.text + ")");
  if (!size_is_sound) return bad_size(name, width, height);
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
  if (!sound_size(width, height)) return bad_size(name, width, height);
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
  std::ifstream file(path, std::ios::binary);
  if (!file) return bad(path, "cannot be opened");
  std::vector<std::uint8_t> bytes;
  char block[1 << 16];
  while (file.read(block, sizeof block) || file.gcount() > 0) {
    bytes.insert(bytes.end(), block, block + file.gcount());
    if (bytes.size() > kLargestFile) return bad(path, "is larger than 256 MB");
  }
  if (file.bad()) return bad(path, "cannot be read");
  return decode_picture(bytes, path);
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
