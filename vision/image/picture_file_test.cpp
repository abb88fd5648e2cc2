// Pictures from files: what comes out is what went in, and damaged files are named.
// SPDX-License-Identifier: Apache-2.0
#include "vision/image/picture_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shared/base/random.hpp"
#include "shared/picture/jpeg.h"
#include "shared/picture/png.h"

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
  const auto bytes =
      picture::encode_png({.width = image.width, .height = image.height, .samples = image.rgb});
  EXPECT_TRUE(bytes) << bytes.error().message;
  return bytes.value_or(Bytes{});
}

Bytes jpeg_of(const Image& image) {
  const auto bytes =
      picture::encode_jpeg({.width = image.width, .height = image.height, .samples = image.rgb},
                           {.quality = 95, .optimized_tables = false});
  EXPECT_TRUE(bytes) << bytes.error().message;
  return bytes.value_or(Bytes{});
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
