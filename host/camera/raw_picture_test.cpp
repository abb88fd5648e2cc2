// Bytes of a camera against colours known by the formulas of the standards.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/raw_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "shared/picture/jpeg.h"

namespace kaz::host {
namespace {

using Bytes = std::vector<std::uint8_t>;

RawLayout layout(PixelFormat format, int width, int height, std::size_t bytes_per_line = 0) {
  RawLayout made;
  made.format = format;
  made.width = width;
  made.height = height;
  made.bytes_per_line = bytes_per_line;
  return made;
}

TEST(RawPicture, YuyvIsTheStandardsColour) {
  // Forward by the formulas of BT.601 and BT.709 in floating point; back within the rounding of Y, U
  // and V: half a step of each is up to 0.6 + 1.2 of 255, and the end is rounded once more.
  const Bytes colors[] = {{255, 0, 0}, {0, 255, 0},   {0, 0, 255},     {255, 255, 255},
                          {0, 0, 0},   {13, 200, 97}, {128, 128, 128}, {250, 120, 3}};
  for (const bool bt709 : {false, true}) {
    for (const bool full : {false, true}) {
      for (const Bytes& color : colors) {
        const double kr = bt709 ? 0.2126 : 0.299, kb = bt709 ? 0.0722 : 0.114;
        const double y = kr * color[0] + (1 - kr - kb) * color[1] + kb * color[2];
        const double u = (color[2] - y) / (2 * (1 - kb)), v = (color[0] - y) / (2 * (1 - kr));
        const auto byte = [](double x) {
          return static_cast<std::uint8_t>(std::clamp(std::lround(x), 0L, 255L));
        };
        const std::uint8_t luma = full ? byte(y) : byte(16 + y * 219 / 255);
        const double range = full ? 1 : 224.0 / 255;
        const Bytes raw{luma, byte(128 + range * u), luma, byte(128 + range * v)};
        RawLayout two = layout(PixelFormat::yuyv, 2, 1);
        two.yuv = {bt709, full};
        vision::Image image;
        ASSERT_TRUE(convert_picture(raw, two, image));
        for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(image.rgb[i], color[i % 3], 2.0);
      }
    }
  }
}

TEST(RawPicture, BytesAtTheEndOfALineAreLeftOut) {
  vision::Image image;
  const Bytes rgb{1, 2, 3, 99, 4, 5, 6};  // the last line may end with its pixels
  ASSERT_TRUE(convert_picture(rgb, layout(PixelFormat::rgb24, 1, 2, 4), image));
  EXPECT_EQ(image.rgb, (Bytes{1, 2, 3, 4, 5, 6}));
  const Bytes grey{7, 99, 8, 99};
  ASSERT_TRUE(convert_picture(grey, layout(PixelFormat::grey, 1, 2, 2), image));
  EXPECT_EQ(image.rgb, (Bytes{7, 7, 7, 8, 8, 8}));
}

TEST(RawPicture, TooFewBytesAreAnError) {
  vision::Image image;
  for (const auto format : {PixelFormat::yuyv, PixelFormat::rgb24, PixelFormat::grey}) {
    const Bytes bytes(15, 0);
    const auto converted = convert_picture(bytes, layout(format, 16, 1), image);
    ASSERT_FALSE(converted);
    EXPECT_NE(converted.error().message.find("has only 15 of "), std::string::npos);
  }
}

// A JPEG of one colour as cameras send it: without Huffman tables (marker C4).
Bytes motion_jpeg(int side, const Bytes& color) {
  Bytes samples;
  for (int i = 0; i < side * side; ++i) samples.insert(samples.end(), color.begin(), color.end());
  const Bytes whole =
      picture::encode_jpeg({side, side, 3, 8, samples}, {.quality = 75, .optimized_tables = false})
          .value();
  Bytes bare(whole.begin(), whole.begin() + 2);
  std::size_t at = 2;
  for (;;) {
    const bool scan = whole[at + 1] == 0xDA, huffman = whole[at + 1] == 0xC4;
    const std::size_t length =
        scan ? whole.size() - at : 2u + (std::size_t{whole[at + 2]} << 8) + whole[at + 3];
    if (!huffman)
      bare.insert(bare.end(), whole.begin() + long(at), whole.begin() + long(at + length));
    at += length;
    if (scan) return bare;
  }
}

TEST(RawPicture, MotionJpegWithoutHuffmanTables) {
  Bytes bytes = motion_jpeg(32, {200, 40, 90});
  ASSERT_EQ(std::search_n(bytes.begin(), bytes.end(), 1, 0xC4), bytes.end());
  bytes.resize(bytes.size() + 100);  // drivers may hand over more than the picture
  vision::Image image;
  const auto converted = convert_picture(bytes, layout(PixelFormat::mjpeg, 32, 32), image);
  ASSERT_TRUE(converted) << converted.error().message;
  ASSERT_EQ(image.rgb.size(), 32u * 32 * 3);
  for (const std::size_t i : {0u, 1500u}) {  // quality 75 rounds the mean by up to 2
    EXPECT_NEAR(image.rgb[i - i % 3], 200, 3);
    EXPECT_NEAR(image.rgb[i - i % 3 + 1], 40, 3);
    EXPECT_NEAR(image.rgb[i - i % 3 + 2], 90, 3);
  }
}

TEST(RawPicture, DamagedMotionJpegIsAnError) {
  const Bytes bytes = motion_jpeg(32, {200, 40, 90});
  vision::Image image;
  const std::span all(bytes);
  for (std::size_t n = 0; n + 2 < bytes.size(); ++n)  // the last two are the end's marker
    EXPECT_FALSE(convert_picture(all.first(n), layout(PixelFormat::mjpeg, 32, 32), image)) << n;
  EXPECT_FALSE(convert_picture(all, layout(PixelFormat::mjpeg, 64, 32), image));
}

TEST(RawPicture, FormatsHaveNames) {
  for (const auto format :
       {PixelFormat::yuyv, PixelFormat::rgb24, PixelFormat::mjpeg, PixelFormat::grey})
    EXPECT_EQ(pixel_format_by_name(pixel_format_name(format)), format);
  EXPECT_FALSE(pixel_format_by_name("h264"));
}

}  // namespace
}  // namespace kaz::host
