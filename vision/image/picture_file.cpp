// Pictures from files: PNG and JPEG by shared/picture, and the two plain formats of Netpbm.
// SPDX-License-Identifier: Apache-2.0
#include "vision/image/picture_file.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "shared/base/files.hpp"
#include "shared/picture/jpeg.h"
#include "shared/picture/png.h"

namespace kaz::vision {
namespace {

constexpr picture::SizeLimits kLimits{.max_side = kLargestPictureSide};
constexpr std::size_t kLargestFile = std::size_t{256} << 20;

using Bytes = std::span<const std::uint8_t>;

bool begins_with(Bytes bytes, std::initializer_list<std::uint8_t> magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

tl::unexpected<Error> bad(const std::string& name, const std::string& what) {
  return fail(Fault::usage, name + ": " + what);
}

tl::unexpected<Error> bad_size(const std::string& name, std::uint64_t width, std::uint64_t height) {
  return bad(name, "is " + std::to_string(width) + " x " + std::to_string(height) +
                       " pixels: must be 1 to " + std::to_string(kLargestPictureSide) +
                       " per side and at most 67 million in total");
}

Result<Image> image_of(picture::Decoded decoded, const std::string& format,
                       const std::string& name) {
  if (decoded) return *std::move(decoded);
  const picture::DecodeError& error = decoded.error();
  if (error.kind == picture::DecodeError::Kind::size)
    return bad_size(name, error.width, error.height);
  return bad(name, "is not a valid " + format + " (" + error.reason + ")");
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
  if (greatest != 255) return bad(name, "is a PGM or PPM whose maximum value is not 255 (8 bits)");
  if (!picture::within(kLimits, width, height)) return bad_size(name, width, height);
  ++at;
  const std::size_t channels = bytes[1] == '6' ? 3 : 1;
  const std::size_t wanted = width * height * channels;
  if (at > bytes.size() || bytes.size() - at < wanted) return bad(name, "ends within the picture");
  Image image{static_cast<int>(width), static_cast<int>(height),
              std::vector<std::uint8_t>(width * height * 3)};
  const Bytes data = bytes.subspan(at, wanted);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = data[channels == 3 ? i : i / 3];
  return image;
}

}  // namespace

Result<Image> decode_picture(Bytes bytes, const std::string& name) {
  if (bytes.empty()) return bad(name, "is empty");
  if (begins_with(bytes, {0x89, 'P', 'N', 'G'}))
    return image_of(picture::decode_png(bytes, kLimits), "PNG", name);
  if (begins_with(bytes, {0xFF, 0xD8}))
    return image_of(picture::decode_jpeg(bytes, kLimits), "JPEG", name);
  if (begins_with(bytes, {'P', '5'}) || begins_with(bytes, {'P', '6'}))
    return decode_netpbm(bytes, name);
  return bad(name, "is not a supported picture: use PNG, JPEG, PGM or PPM");
}

Result<Image> read_picture(const std::string& path) {
  const auto bytes =
      KAZ_TRY(read_whole_file(path, kLargestFile, "give a picture: PNG, JPEG, PGM or PPM"));
  return decode_picture({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, path);
}

bool looks_like_picture(const std::string& path) {
  const auto file = open_input(path);
  char first[3] = {};
  if (!file || ::read(file->get(), first, sizeof first) != sizeof first) return false;
  const auto begins = [&](std::string_view with) {
    return std::string_view(first, sizeof first).starts_with(with);
  };
  return begins("\x89PN") || begins("\xff\xd8\xff") || begins("P6") || begins("P5");
}

}  // namespace kaz::vision
