// Pictures from files: what comes out is what went in, and damaged files are named.
// SPDX-License-Identifier: Apache-2.0
#include "vision/image/picture_file.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cstdio>
#include <cstdlib>
#include <span>

#include <jpeglib.h>

#include "shared/base/random.hpp"

namespace kaz::vision {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Smooth, so that a JPEG keeps it nearly.
Image soft_picture(int width, int height) {
  Image image{width, height, {}};
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      image.rgb.push_back(static_cast<std::uint8_t>(40 + 2 * u));
      image.rgb.push_back(static_cast<std::uint8_t>(60 + 2 * v));
      image.rgb.push_back(static_cast<std::uint8_t>(90 + u + v));
    }
  }
  return image;
}

Bytes png_of(const Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<unsigned>(image.width);
  png.height = static_cast<unsigned>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  EXPECT_TRUE(png_image_write_to_memory(&png, nullptr, &size, 0, image.rgb.data(), 0, nullptr));
  Bytes bytes(size);
  EXPECT_TRUE(
      png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr));
  bytes.resize(size);
  return bytes;
}

Bytes jpeg_of(Image image, std::span<const jpeg_scan_info> scans = {}) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &memory, &size);
  jpeg.image_width = static_cast<unsigned>(image.width);
  jpeg.image_height = static_cast<unsigned>(image.height);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 95, TRUE);
  if (!scans.empty()) {
    jpeg.scan_info = scans.data();
    jpeg.num_scans = static_cast<int>(scans.size());
  }
  jpeg_start_compress(&jpeg, TRUE);
  for (int v = 0; v < image.height; ++v) {
    JSAMPROW row = &image.rgb[static_cast<std::size_t>(v * image.width * 3)];
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  Bytes bytes(memory, memory + size);
  std::free(memory);
  return bytes;
}

Bytes netpbm_of(const Image& image, bool grey) {
  const std::string head = std::string(grey ? "P5" : "P6") + "\n# by a test\n" +
                           std::to_string(image.width) + " " + std::to_string(image.height) +
                           "\n255\n";
  Bytes bytes(head.begin(), head.end());
  for (std::size_t i = 0; i < image.rgb.size(); i += grey ? 3 : 1) bytes.push_back(image.rgb[i]);
  return bytes;
}

TEST(PictureFile, KeepsEveryByteOfPngAndPpm) {
  const Image image = soft_picture(37, 23);
  for (const Bytes& bytes : {png_of(image), netpbm_of(image, false)}) {
    const auto read = decode_picture(bytes, "a");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->width, 37);
    EXPECT_EQ(read->height, 23);
    EXPECT_EQ(read->rgb, image.rgb);
  }
}

TEST(PictureFile, GreyBecomesEqualParts) {
  const Image image = soft_picture(8, 5);
  const auto read = decode_picture(netpbm_of(image, true), "a");
  ASSERT_TRUE(read) << read.error().message;
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    EXPECT_EQ(read->rgb[i], image.rgb[i - i % 3]) << i;
}

TEST(PictureFile, JpegIsNearlyThePicture) {
  const Image image = soft_picture(64, 48);
  const auto read = decode_picture(jpeg_of(image), "a");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->rgb.size(), image.rgb.size());
  // Quality 95 with halved colour on a smooth picture: a few codes.
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    EXPECT_NEAR(read->rgb[i], image.rgb[i], 8) << i;
}

// A JPEG that has two sizes: to a reader that takes `FF 00` for a marker with a length, the segment that
// begins so ends within a comment, where the head of a picture of one pixel stands. libjpeg skips
// `FF 00`, finds the real head in the segment, and writes as many pixels as that says.
Bytes with_decoy_size(const Bytes& jpeg) {
  std::size_t scan = 2;  // where the scan begins
  while (jpeg[scan + 1] != 0xDA) scan += 2 + (jpeg[scan + 2] << 8 | jpeg[scan + 3]);
  const Bytes decoy{0xFF, 0xC0, 0, 17, 8, 0, 1, 0, 1, 3, 1, 0x22, 0, 2, 0x11, 1, 3, 0x11, 1};
  const std::size_t length = scan - 2 + 2 + 4;  // of tables and real head, and the comment's head
  Bytes bytes{0xFF,
              0xD8,
              0xFF,
              0,
              static_cast<std::uint8_t>(length >> 8),
              static_cast<std::uint8_t>(length)};
  bytes.insert(bytes.end(), jpeg.begin() + 2, jpeg.begin() + static_cast<std::ptrdiff_t>(scan));
  bytes.insert(bytes.end(), {0xFF, 0xFE, 0, static_cast<std::uint8_t>(2 + decoy.size())});
  bytes.insert(bytes.end(), decoy.begin(), decoy.end());
  bytes.insert(bytes.end(), jpeg.begin() + static_cast<std::ptrdiff_t>(scan), jpeg.end());
  return bytes;
}

TEST(PictureFile, AJpegHasTheSizeThatIsWritten) {
  const Bytes jpeg = jpeg_of(soft_picture(640, 480));
  const auto plain = decode_picture(jpeg, "a"), read = decode_picture(with_decoy_size(jpeg), "a");
  ASSERT_TRUE(plain);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->width, 640);
  EXPECT_EQ(read->height, 480);
  EXPECT_EQ(read->rgb, plain->rgb);
}

// One scan for each component; the last one again and again, which costs bytes of the file and a pass
// over the picture.
TEST(PictureFile, AJpegOfManyScansIsRefused) {
  constexpr jpeg_scan_info scans[] = {
      {1, {0}, 0, 63, 0, 0}, {1, {1}, 0, 63, 0, 0}, {1, {2}, 0, 63, 0, 0}};
  const Bytes bytes = jpeg_of(soft_picture(64, 48), scans);
  std::size_t last = 0;
  for (std::size_t at = 0; at + 1 < bytes.size(); ++at)
    if (bytes[at] == 0xFF && bytes[at + 1] == 0xDA) last = at;
  ASSERT_GT(last, 0u);
  const auto tail = bytes.begin() + static_cast<std::ptrdiff_t>(last);
  const auto repeated = [&](int times) {
    Bytes many(bytes.begin(), tail);
    for (int i = 0; i < times; ++i) many.insert(many.end(), tail, bytes.end() - 2);
    many.insert(many.end(), {0xFF, 0xD9});
    return many;
  };
  for (const int times : {1, 50}) {
    const auto read = decode_picture(repeated(times), "a");
    EXPECT_TRUE(read) << read.error().message;
  }
  const auto read = decode_picture(repeated(200), "a");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message, "a: is not a valid JPEG (more than 100 scans)");
}

TEST(PictureFile, EndsTooEarlyAtWhateverByte) {
  const Image image = soft_picture(24, 20);
  for (const Bytes& bytes :
       {png_of(image), jpeg_of(image), netpbm_of(image, false), netpbm_of(image, true)}) {
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      // A PNG's last chunk holds no picture: without it nothing is missing.
      if (bytes[0] == 0x89 && length >= bytes.size() - 12) break;
      const auto read = decode_picture({bytes.data(), length}, "cut.jpg");
      ASSERT_FALSE(read) << length << " of " << bytes.size() << ", first " << int{bytes[0]};
      ASSERT_EQ(read.error().message.rfind("cut.jpg: ", 0), 0u) << read.error().message;
    }
  }
}

TEST(PictureFile, DamagedBytesNeverDoHarm) {
  const Image image = soft_picture(24, 20);
  Random random(5);
  for (const Bytes& whole : {png_of(image), jpeg_of(image), netpbm_of(image, false)}) {
    for (int round = 0; round < 2000; ++round) {
      Bytes bytes = whole;
      for (int i = 0; i < 3; ++i) {
        // Twice as often in the head, where sizes and tables are.
        const auto range = static_cast<std::uint32_t>(
            round % 2 ? bytes.size() : std::min<std::size_t>(40, bytes.size()));
        bytes[random.below(range)] = static_cast<std::uint8_t>(random.below(256));
      }
      const auto read = decode_picture(bytes, "a");
      if (read) {
        ASSERT_EQ(read->rgb.size(), static_cast<std::size_t>(read->width * read->height * 3));
      }
    }
  }
}

TEST(PictureFile, SaysWhatCannotBeRead) {
  const auto message = [](const std::string& content) {
    const Bytes bytes(content.begin(), content.end());
    const auto read = decode_picture(bytes, "a");
    return read ? std::string("read") : read.error().message;
  };
  EXPECT_NE(message("").find("empty"), std::string::npos);
  EXPECT_NE(message("GIF89a").find("PNG, JPEG"), std::string::npos);
  EXPECT_NE(message("P6\n0 4\n255\n").find("0 x 4"), std::string::npos);
  EXPECT_NE(message("P6\n99999 99999\n255\n").find("99999 x 99999"), std::string::npos);
  EXPECT_NE(message("P6\n16000 16000\n255\n").find("67 million"), std::string::npos);
  EXPECT_NE(message("P6\n4 4\n65535\n").find("8 bits"), std::string::npos);
  const auto none = read_picture("/nowhere/left01.jpg");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("/nowhere/left01.jpg"), std::string::npos);
  EXPECT_FALSE(read_picture("/"));
}

}  // namespace
}  // namespace kaz::vision
