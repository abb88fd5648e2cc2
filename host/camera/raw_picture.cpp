// YUV by integer arithmetic of 16 binary places; JPEG by the reader of picture files.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/raw_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "vision/image/picture_file.h"

namespace kaz::host {
namespace {

constexpr std::array<std::pair<PixelFormat, std::string_view>, 4> kNames{
    {{PixelFormat::yuyv, "yuyv"},
     {PixelFormat::rgb24, "rgb24"},
     {PixelFormat::mjpeg, "mjpeg"},
     {PixelFormat::grey, "grey"}}};

constexpr int kPlaces = 16;

// R = y Y' + rv V, G = y Y' - gu U - gv V, B = y Y' + bu U with Y' = Y - black, U and V from 0.
struct YuvToRgb {
  int black, y, rv, gu, gv, bu;
};

// From Y = kr R + (1 - kr - kb) G + kb B, U = (B - Y) / (2 (1 - kb)), V = (R - Y) / (2 (1 - kr)).
YuvToRgb yuv_to_rgb(YuvMeaning meaning) {
  const double kr = meaning.bt709 ? 0.2126 : 0.299, kb = meaning.bt709 ? 0.0722 : 0.114;
  const double kg = 1 - kr - kb;
  const double y = meaning.full_range ? 1 : 255.0 / 219, c = meaning.full_range ? 1 : 255.0 / 224;
  const auto fixed = [](double x) { return static_cast<int>(std::lround(x * (1 << kPlaces))); };
  return {meaning.full_range ? 0 : 16,       fixed(y),
          fixed(c * 2 * (1 - kr)),           fixed(c * 2 * (1 - kb) * kb / kg),
          fixed(c * 2 * (1 - kr) * kr / kg), fixed(c * 2 * (1 - kb))};
}

std::uint8_t to_byte(int fixed) {
  return static_cast<std::uint8_t>(std::clamp((fixed + (1 << (kPlaces - 1))) >> kPlaces, 0, 255));
}

void yuyv_row(const std::uint8_t* from, int width, const YuvToRgb& m, std::uint8_t* to) {
  for (int x = 0; x + 1 < width; x += 2, from += 4) {
    const int u = from[1] - 128, v = from[3] - 128;
    const int red = m.rv * v, green = -m.gu * u - m.gv * v, blue = m.bu * u;
    for (const int luma : {from[0], from[2]}) {
      const int y = m.y * (luma - m.black);
      *to++ = to_byte(y + red);
      *to++ = to_byte(y + green);
      *to++ = to_byte(y + blue);
    }
  }
}

std::size_t bytes_of_row(const RawLayout& layout) {
  const auto width = static_cast<std::size_t>(layout.width);
  switch (layout.format) {
    case PixelFormat::yuyv:
      return 2 * width;
    case PixelFormat::rgb24:
      return 3 * width;
    case PixelFormat::mjpeg:
    case PixelFormat::grey:
      break;
  }
  return width;
}

Result<void> convert_jpeg(std::span<const std::uint8_t> bytes, const RawLayout& layout,
                          vision::Image& image) {
  auto decoded = KAZ_TRY(vision::decode_picture(bytes, "the picture"));
  if (decoded.width != layout.width || decoded.height != layout.height)
    return fail(Fault::environment,
                "the picture has an unexpected size: " + std::to_string(decoded.width) + " x " +
                    std::to_string(decoded.height));
  image = std::move(decoded);
  return {};
}

}  // namespace

std::string_view pixel_format_name(PixelFormat format) {
  return std::ranges::find(kNames, format, &decltype(kNames)::value_type::first)->second;
}

std::optional<PixelFormat> pixel_format_by_name(std::string_view name) {
  const auto found = std::ranges::find(kNames, name, &decltype(kNames)::value_type::second);
  if (found == kNames.end()) return std::nullopt;
  return found->first;
}

Result<void> convert_picture(std::span<const std::uint8_t> bytes, const RawLayout& layout,
                             vision::Image& image) {
  if (layout.format == PixelFormat::mjpeg) return convert_jpeg(bytes, layout, image);
  const std::size_t row = bytes_of_row(layout), stride = std::max(layout.bytes_per_line, row);
  const auto width = static_cast<std::size_t>(layout.width);
  const auto height = static_cast<std::size_t>(layout.height);
  const std::size_t wanted = height == 0 ? 0 : stride * (height - 1) + row;
  if (bytes.size() < wanted)
    return fail(Fault::environment, "the picture has only " + std::to_string(bytes.size()) +
                                        " of " + std::to_string(wanted) + " bytes");
  image.width = layout.width;
  image.height = layout.height;
  image.rgb.resize(3 * width * height);
  const YuvToRgb matrix = yuv_to_rgb(layout.yuv);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* from = bytes.data() + y * stride;
    std::uint8_t* to = image.rgb.data() + 3 * width * y;
    if (layout.format == PixelFormat::yuyv) {
      yuyv_row(from, layout.width, matrix, to);
    } else if (layout.format == PixelFormat::rgb24) {
      std::copy_n(from, row, to);
    } else {
      for (std::size_t x = 0; x < width; ++x, to += 3) std::fill_n(to, 3, from[x]);
    }
  }
  return {};
}

}  // namespace kaz::host
