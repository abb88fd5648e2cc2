// JPEG: round trips, limits, damaged files, and files made to mislead a reader.
// SPDX-License-Identifier: Apache-2.0
#include "shared/picture/jpeg.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string_view>
#include <utility>

#include <jpeglib.h>

#include "shared/base/random.hpp"
#include "shared/picture/exif.h"

namespace kaz::picture {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Kind = DecodeError::Kind;

// Smooth, so that a JPEG keeps it nearly.
Bytes soft_samples(int width, int height, int channels = 3) {
  Bytes samples;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const int codes[] = {40 + 2 * u, 60 + 2 * v, 90 + u + v};
      for (int c = 0; c < channels; ++c) samples.push_back(static_cast<std::uint8_t>(codes[c]));
    }
  }
  return samples;
}

// With one scan for each component: by libjpeg itself, since encode_jpeg writes a single one.
Bytes jpeg_of_three_scans(int width, int height) {
  constexpr jpeg_scan_info scans[] = {
      {1, {0}, 0, 63, 0, 0}, {1, {1}, 0, 63, 0, 0}, {1, {2}, 0, 63, 0, 0}};
  Bytes samples = soft_samples(width, height);
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &memory, &size);
  jpeg.image_width = static_cast<unsigned>(width);
  jpeg.image_height = static_cast<unsigned>(height);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 95, TRUE);
  jpeg.scan_info = scans;
  jpeg.num_scans = 3;
  jpeg_start_compress(&jpeg, TRUE);
  for (int v = 0; v < height; ++v) {
    JSAMPROW row = &samples[static_cast<std::size_t>(v * width * 3)];
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  Bytes bytes(memory, memory + size);
  std::free(memory);
  return bytes;
}

Bytes encoded(int width, int height, const JpegSettings& settings = {.quality = 95}) {
  const Bytes samples = soft_samples(width, height);
  const auto bytes = encode_jpeg({width, height, 3, 8, samples}, settings);
  EXPECT_TRUE(bytes) << bytes.error().message;
  return bytes.value_or(Bytes{});
}

TEST(Jpeg, IsNearlyThePicture) {
  const Bytes samples = soft_samples(64, 48);
  for (const bool optimized : {true, false}) {
    const auto read = decode_jpeg(encoded(64, 48, {95, optimized}));
    ASSERT_TRUE(read) << read.error().reason;
    EXPECT_EQ(read->width, 64);
    EXPECT_EQ(read->height, 48);
    ASSERT_EQ(read->rgb.size(), samples.size());
    // Quality 95 with halved colour on a smooth picture: a few codes.
    for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_NEAR(read->rgb[i], samples[i], 8) << i;
  }
}

TEST(Jpeg, GreyBecomesEqualParts) {
  const Bytes samples = soft_samples(64, 48, 1);
  const auto bytes = encode_jpeg({64, 48, 1, 8, samples}, {.quality = 95});
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto read = decode_jpeg(*bytes);
  ASSERT_TRUE(read) << read.error().reason;
  ASSERT_EQ(read->rgb.size(), 3 * samples.size());
  for (std::size_t i = 0; i < read->rgb.size(); ++i) {
    EXPECT_NEAR(read->rgb[i], samples[i / 3], 4) << i;
    EXPECT_EQ(read->rgb[i], read->rgb[i - i % 3]) << i;
  }
}

// More than one output buffer (16 KB), and settings that matter.
TEST(Jpeg, SettingsChangeTheSize) {
  Random random(3);
  Bytes samples(3 * 400 * 300);
  for (std::uint8_t& sample : samples) sample = static_cast<std::uint8_t>(random.below(256));
  const auto size = [&](const JpegSettings& settings) {
    const auto bytes = encode_jpeg({400, 300, 3, 8, samples}, settings);
    EXPECT_TRUE(bytes && decode_jpeg(*bytes));
    return bytes ? bytes->size() : 0;
  };
  EXPECT_GT(size({90, true}), 2u * 16384);
  EXPECT_LT(size({50, true}), size({90, true}));
  EXPECT_LT(size({90, true}), size({90, false}));
}

TEST(Jpeg, PixelsOfAnotherSizeAreRefused) {
  const Bytes twelve(12), wide(65501);
  for (const PixelView& pixels :
       {PixelView{}, PixelView{2, 3, 3, 8, twelve}, PixelView{2, 1, 3, 16, twelve},
        PixelView{-2, -2, 3, 8, twelve}, PixelView{65501, 1, 1, 8, wide}}) {
    const auto bytes = encode_jpeg(pixels);
    ASSERT_FALSE(bytes);
    EXPECT_EQ(bytes.error().fault, Fault::usage);
  }
  EXPECT_EQ(encode_jpeg({65501, 1, 1, 8, wide}).error().message,
            "a picture of 65501 x 1 cannot be a JPEG file");
  EXPECT_TRUE(encode_jpeg({2, 2, 3, 8, twelve}));
}

TEST(Jpeg, SizesBeyondTheLimitsAreErrors) {
  const Bytes bytes = encoded(64, 48);
  EXPECT_TRUE(decode_jpeg(bytes, {.max_side = 64, .max_pixels = 64 * 48}));
  for (const SizeLimits& limits :
       {SizeLimits{.max_side = 63}, SizeLimits{.max_pixels = 64 * 48 - 1}}) {
    const auto read = decode_jpeg(bytes, limits);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().kind, Kind::size);
    EXPECT_EQ(read.error().width, 64u);
    EXPECT_EQ(read.error().height, 48u);
  }
}

TEST(Jpeg, EndsTooEarlyAtWhateverByte) {
  const Bytes bytes = encoded(24, 20);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const auto read = decode_jpeg({bytes.data(), length});
    ASSERT_FALSE(read) << length;
    EXPECT_EQ(read.error().kind, Kind::invalid);
    EXPECT_FALSE(read.error().reason.empty());
  }
}

TEST(Jpeg, DamagedBytesNeverDoHarm) {
  const Bytes whole = encoded(24, 20);
  Random random(5);
  for (int round = 0; round < 1000; ++round) {
    Bytes bytes = whole;
    for (int i = 0; i < 3; ++i)
      bytes[random.below(static_cast<std::uint32_t>(bytes.size()))] =
          static_cast<std::uint8_t>(random.below(256));
    const auto read = decode_jpeg(bytes);
    if (read) {
      ASSERT_EQ(read->rgb.size(), static_cast<std::size_t>(read->width * read->height * 3));
    }
  }
}

// The data of an APP1 segment with a directory of two entries: the maker's name, and the orientation.
Bytes exif(std::uint8_t orientation, bool little) {
  const auto number = [&](Bytes& to, std::uint32_t value, int size) {
    for (int k = 0; k < size; ++k)
      to.push_back(static_cast<std::uint8_t>(value >> 8 * (little ? k : size - 1 - k)));
  };
  Bytes data{'E', 'x', 'i', 'f', 0, 0};
  data.insert(data.end(), 2, little ? 'I' : 'M');
  number(data, 42, 2), number(data, 8, 4), number(data, 2, 2);
  number(data, 0x010F, 2), number(data, 2, 2), number(data, 4, 4), number(data, 0x6B617A00, 4);
  number(data, 0x0112, 2), number(data, 3, 2), number(data, 1, 4), number(data, orientation, 2);
  number(data, 0, 2), number(data, 0, 4);
  return data;
}

// Puts an APP1 segment behind the start of the picture.
Bytes with_app1(const Bytes& jpeg, std::span<const std::uint8_t> data) {
  const std::size_t length = data.size() + 2;
  Bytes bytes{0xFF,
              0xD8,
              0xFF,
              0xE1,
              static_cast<std::uint8_t>(length >> 8),
              static_cast<std::uint8_t>(length)};
  bytes.insert(bytes.end(), data.begin(), data.end());
  bytes.insert(bytes.end(), jpeg.begin() + 2, jpeg.end());
  return bytes;
}

// The sides of the upright picture at which the first row and the first column of the file belong
// (Exif 2.32, section 4.6.4).
TEST(Jpeg, IsTurnedByItsExifOrientation) {
  const Bytes jpeg = encoded(24, 20);
  const auto stored = decode_jpeg(jpeg);
  ASSERT_TRUE(stored);
  constexpr struct {
    std::string_view row, column;
  } kSides[] = {{"top", "left"}, {"top", "right"}, {"bottom", "right"}, {"bottom", "left"},
                {"left", "top"}, {"right", "top"}, {"right", "bottom"}, {"left", "bottom"}};
  for (std::uint8_t orientation = 1; orientation <= 8; ++orientation) {
    for (const bool little : {false, true}) {
      const auto read = decode_jpeg(with_app1(jpeg, exif(orientation, little)));
      ASSERT_TRUE(read) << read.error().reason;
      const auto [row_side, column_side] = kSides[orientation - 1];
      EXPECT_EQ(read->width, orientation < 5 ? 24 : 20);
      EXPECT_EQ(read->height, orientation < 5 ? 20 : 24);
      for (int row = 0; row < 20; ++row) {
        for (int column = 0; column < 24; ++column) {
          int x = 0, y = 0;
          for (const auto& [side, at] : {std::pair{row_side, row}, {column_side, column}}) {
            if (side == "left") x = at;
            if (side == "right") x = read->width - 1 - at;
            if (side == "top") y = at;
            if (side == "bottom") y = read->height - 1 - at;
          }
          for (int c = 0; c < 3; ++c)
            ASSERT_EQ(read->rgb[static_cast<std::size_t>(3 * (y * read->width + x) + c)],
                      stored->rgb[static_cast<std::size_t>(3 * (row * 24 + column) + c)])
                << int{orientation} << " " << row << " " << column;
        }
      }
    }
  }
}

TEST(Jpeg, InvalidExifTurnsNothing) {
  const Bytes jpeg = encoded(24, 20);
  const auto stored = decode_jpeg(jpeg);
  ASSERT_TRUE(stored);
  const auto expect_unturned = [&](std::span<const std::uint8_t> app1) {
    EXPECT_EQ(exif_orientation(app1), 1);
    const auto read = decode_jpeg(with_app1(jpeg, app1));
    ASSERT_TRUE(read) << read.error().reason;
    EXPECT_EQ(read->rgb, stored->rgb);
  };
  for (const bool little : {false, true}) {
    const Bytes whole = exif(6, little);
    EXPECT_EQ(exif_orientation(whole), 6);
    for (const int value : {0, 9, 255})
      expect_unturned(exif(static_cast<std::uint8_t>(value), little));
    // Cut before the end of the value: "Exif", 8 + 2 bytes, an entry, and 10 bytes of the next.
    for (std::size_t size = 0; size < 6 + 10 + 12 + 10; ++size)
      expect_unturned(std::span(whole).first(size));
    // A directory at the end of the range of offsets.
    Bytes far = whole;
    std::fill_n(far.begin() + 6 + 4, 4, std::uint8_t{0xFF});
    expect_unturned(far);
  }
  Bytes xmp = exif(6, true);
  xmp[0] = 'h';
  expect_unturned(xmp);
}

TEST(Jpeg, DamagedExifNeverDoesHarm) {
  Random random(11);
  for (int round = 0; round < 20'000; ++round) {
    Bytes app1 = exif(static_cast<std::uint8_t>(1 + random.below(8)), random.below(2) == 0);
    for (int i = 0; i < 3; ++i)
      app1[6 + random.below(static_cast<std::uint32_t>(app1.size() - 6))] =
          static_cast<std::uint8_t>(random.below(256));
    const Bytes part(app1.begin(),
                     app1.begin() + random.below(static_cast<std::uint32_t>(app1.size() + 1)));
    for (const Bytes& data : {app1, part}) {
      const int orientation = exif_orientation(data);
      ASSERT_TRUE(orientation >= 1 && orientation <= 8) << orientation;
    }
  }
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

TEST(Jpeg, AJpegHasTheSizeThatIsWritten) {
  const Bytes jpeg = encoded(640, 480);
  const auto plain = decode_jpeg(jpeg), read = decode_jpeg(with_decoy_size(jpeg));
  ASSERT_TRUE(plain);
  ASSERT_TRUE(read) << read.error().reason;
  EXPECT_EQ(read->width, 640);
  EXPECT_EQ(read->height, 480);
  EXPECT_EQ(read->rgb, plain->rgb);
}

// One scan for each component; the last one again and again, which costs bytes of the file and a pass
// over the picture.
TEST(Jpeg, AJpegOfManyScansIsRefused) {
  const Bytes bytes = jpeg_of_three_scans(64, 48);
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
    const auto read = decode_jpeg(repeated(times));
    EXPECT_TRUE(read) << read.error().reason;
  }
  const auto read = decode_jpeg(repeated(200));
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, Kind::invalid);
  EXPECT_EQ(read.error().reason, "more than 100 scans");
}

}  // namespace
}  // namespace kaz::picture
