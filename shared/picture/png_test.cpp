// PNG: round trips of all kinds of samples, the bytes of recordings, limits, damaged files.
// SPDX-License-Identifier: Apache-2.0
#include "shared/picture/png.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "shared/base/random.hpp"
#include "shared/picture/png_testing.h"

namespace kaz::picture {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Kind = DecodeError::Kind;

constexpr int kWidth = 31, kHeight = 17;

// Smooth with some noise, so that filters matter.
Bytes samples_of(int channels, int bits) {
  Random random(7);
  Bytes samples;
  for (int i = 0; i < kWidth * kHeight * channels * bits / 8; ++i)
    samples.push_back(static_cast<std::uint8_t>(i / 5 + static_cast<int>(random.below(9))));
  return samples;
}

Bytes encoded(int channels, int bits, const PngSettings& settings = {}) {
  const Bytes samples = samples_of(channels, bits);
  const auto bytes = encode_png({kWidth, kHeight, channels, bits, samples}, settings);
  EXPECT_TRUE(bytes) << bytes.error().message;
  return bytes.value_or(Bytes{});
}

TEST(Png, StoresEverySampleAtAllSettings) {
  for (const int channels : {1, 3}) {
    for (const int bits : {8, 16}) {
      for (const PngSettings& settings :
           {PngSettings{}, PngSettings{3, false, true}, PngSettings{0, true, false},
            PngSettings{9, false, false}}) {
        const auto stored = stored_png(encoded(channels, bits, settings));
        ASSERT_TRUE(stored);
        EXPECT_EQ(stored->width, kWidth);
        EXPECT_EQ(stored->height, kHeight);
        EXPECT_EQ(stored->channels, channels);
        EXPECT_EQ(stored->bits, bits);
        EXPECT_EQ(stored->srgb, settings.srgb);
        EXPECT_EQ(stored->gamma, settings.srgb);
        EXPECT_EQ(stored->samples, samples_of(channels, bits));
      }
    }
  }
}

TEST(Png, EightBitsComeBackAsRgb) {
  const auto rgb = decode_png(encoded(3, 8)), grey = decode_png(encoded(1, 8));
  ASSERT_TRUE(rgb);
  EXPECT_EQ(rgb->width, kWidth);
  EXPECT_EQ(rgb->height, kHeight);
  EXPECT_EQ(rgb->rgb, samples_of(3, 8));
  ASSERT_TRUE(grey);
  const Bytes samples = samples_of(1, 8);
  ASSERT_EQ(grey->rgb.size(), 3 * samples.size());
  for (std::size_t i = 0; i < grey->rgb.size(); ++i) ASSERT_EQ(grey->rgb[i], samples[i / 3]) << i;
}

// Recordings of the same seed are the same bytes, also those that were made when libpng's simplified
// interface wrote them.
TEST(Png, RecordingsAreTheBytesOfTheSimplifiedInterface) {
  const Bytes samples = samples_of(3, 8);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = kWidth;
  png.height = kHeight;
  png.format = PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;
  Bytes expected(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = expected.size();
  ASSERT_TRUE(
      png_image_write_to_memory(&png, expected.data(), &size, 0, samples.data(), 0, nullptr));
  expected.resize(size);
  EXPECT_EQ(encoded(3, 8, {.level = 3, .filters = false, .srgb = true}), expected);
}

TEST(Png, SettingsChangeTheSize) {
  EXPECT_LT(encoded(3, 8, {.level = 9}).size(), encoded(3, 8, {.level = 0}).size());
  EXPECT_NE(encoded(3, 8, {.filters = true}), encoded(3, 8, {.filters = false}));
}

TEST(Png, NamesWhatHasMadeIt) {
  const Bytes bytes = encoded(3, 8, {.software = "kaz test"});
  const std::string text(bytes.begin(), bytes.end());
  EXPECT_LT(text.find(std::string("tEXtSoftware\0kaz test", 21)), text.find("IDAT"));
  EXPECT_EQ(decode_png(bytes)->rgb, samples_of(3, 8));
}

TEST(Png, PixelsOfAnotherSizeAreRefused) {
  const Bytes twelve(12);
  for (const PixelView& pixels :
       {PixelView{}, PixelView{0, 4, 3, 8, {}}, PixelView{-2, -2, 3, 8, twelve},
        PixelView{2, 3, 3, 8, twelve}, PixelView{2, 2, 3, 16, twelve},
        PixelView{3, 2, 2, 8, twelve}, PixelView{4, 3, 1, 12, twelve}}) {
    const auto bytes = encode_png(pixels);
    ASSERT_FALSE(bytes);
    EXPECT_EQ(bytes.error().fault, Fault::usage);
  }
  EXPECT_EQ(encode_png({2, 3, 3, 8, twelve}).error().message,
            "invalid picture: 2 x 3 pixels with 12 bytes");
  EXPECT_TRUE(encode_png({2, 2, 3, 8, twelve}));
  // libpng's own limit is a million pixels a side.
  const Bytes wide(2'000'000);
  const auto refused = encode_png({2'000'000, 1, 1, 8, wide});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::failed);
}

TEST(Png, SizesBeyondTheLimitsAreErrors) {
  const Bytes bytes = encoded(3, 8);
  EXPECT_TRUE(decode_png(bytes, {.max_side = kWidth, .max_pixels = kWidth * kHeight}));
  for (const SizeLimits& limits :
       {SizeLimits{.max_side = kWidth - 1}, SizeLimits{.max_pixels = kWidth * kHeight - 1}}) {
    const auto decoded = decode_png(bytes, limits);
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error().kind, Kind::size);
    EXPECT_EQ(decoded.error().width, std::uint64_t{kWidth});
    EXPECT_EQ(decoded.error().height, std::uint64_t{kHeight});
  }
}

TEST(Png, EndsTooEarlyAtWhateverByte) {
  const Bytes bytes = encoded(3, 8);
  // The last chunk, of 12 bytes, holds no picture: without it nothing is missing.
  for (std::size_t length = 0; length < bytes.size() - 12; ++length) {
    const auto decoded = decode_png({bytes.data(), length});
    ASSERT_FALSE(decoded) << length;
    EXPECT_EQ(decoded.error().kind, Kind::invalid);
    EXPECT_FALSE(decoded.error().reason.empty());
  }
}

// A chunk of a PNG: length, type, data, and the CRC-32 of type and data (PNG 1.2, sections 3.2 and 3.4).
Bytes chunk(const std::string& type, std::span<const std::uint8_t> data) {
  const auto big_endian = [](std::uint32_t number) {
    Bytes bytes;
    for (int shift = 24; shift >= 0; shift -= 8)
      bytes.push_back(static_cast<std::uint8_t>(number >> shift));
    return bytes;
  };
  Bytes bytes(type.begin(), type.end());
  bytes.insert(bytes.end(), data.begin(), data.end());
  std::uint32_t crc = 0xFFFFFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? 0xEDB88320 ^ crc >> 1 : crc >> 1;
  }
  const Bytes length = big_endian(static_cast<std::uint32_t>(data.size())), sum = big_endian(~crc);
  bytes.insert(bytes.begin(), length.begin(), length.end());
  bytes.insert(bytes.end(), sum.begin(), sum.end());
  return bytes;
}

// Colors below 200 and alpha from 0 to 255, so that blending and gamma correction would change them.
Bytes with_alpha(png_uint_32 format, Bytes& samples) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = kWidth;
  png.height = kHeight;
  png.format = format;
  samples = {};
  const std::size_t channels = PNG_IMAGE_SAMPLE_CHANNELS(format);
  for (std::size_t i = 0; i < kWidth * kHeight; ++i) {
    for (std::size_t c = 0; c + 1 < channels; ++c)
      samples.push_back(static_cast<std::uint8_t>((7 * i + 50 * c) % 200));
    samples.push_back(static_cast<std::uint8_t>(i % 3 == 0 ? 0 : i % 256));
  }
  Bytes bytes(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = bytes.size();
  EXPECT_TRUE(png_image_write_to_memory(&png, bytes.data(), &size, 0, samples.data(), 0, nullptr));
  bytes.resize(size);
  return bytes;
}

TEST(Png, AlphaLeavesTheColorsAsTheyAre) {
  Bytes samples;
  const auto rgba = decode_png(with_alpha(PNG_FORMAT_RGBA, samples));
  ASSERT_TRUE(rgba) << rgba.error().reason;
  ASSERT_EQ(rgba->rgb.size(), samples.size() / 4 * 3);
  for (std::size_t i = 0; i < rgba->rgb.size(); ++i)
    ASSERT_EQ(rgba->rgb[i], samples[i / 3 * 4 + i % 3]) << i;
  const auto gray = decode_png(with_alpha(PNG_FORMAT_GA, samples));
  ASSERT_TRUE(gray) << gray.error().reason;
  ASSERT_EQ(gray->rgb.size(), samples.size() / 2 * 3);
  for (std::size_t i = 0; i < gray->rgb.size(); ++i)
    ASSERT_EQ(gray->rgb[i], samples[i / 3 * 2]) << i;
}

// A palette of two colors; the first has alpha 0.
TEST(Png, TransparentPaletteColorsAreKept) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = 2;
  png.height = 1;
  png.format = PNG_FORMAT_RGBA_COLORMAP;
  png.colormap_entries = 2;
  const std::uint8_t colors[] = {200, 30, 20, 0, 10, 150, 90, 255}, samples[] = {0, 1};
  Bytes bytes(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = bytes.size();
  ASSERT_TRUE(png_image_write_to_memory(&png, bytes.data(), &size, 0, samples, 0, colors));
  bytes.resize(size);
  const auto picture = decode_png(bytes);
  ASSERT_TRUE(picture) << picture.error().reason;
  EXPECT_EQ(picture->rgb, (Bytes{200, 30, 20, 10, 150, 90}));
}

TEST(Png, SixteenBitsLoseTheirLowByte) {
  for (const int channels : {1, 3}) {
    const Bytes samples = samples_of(channels, 16);
    const auto picture = decode_png(encoded(channels, 16));
    ASSERT_TRUE(picture) << picture.error().reason;
    for (std::size_t i = 0; i < picture->rgb.size(); ++i)
      ASSERT_EQ(picture->rgb[i], samples[2 * (channels == 3 ? i : i / 3)]) << i;
  }
}

// Inserted behind IHDR, which ends after 8 + 25 bytes.
TEST(Png, ChunksForGammaAndTransparencyChangeNoColor) {
  const Bytes gamma{0, 0, 0x4e, 0x20}, key{0, 0, 0, 0, 0, 1}, whole = encoded(3, 8);
  for (const Bytes& part : {chunk("gAMA", gamma), chunk("tRNS", key)}) {
    Bytes bytes = whole;
    bytes.insert(bytes.begin() + 8 + 25, part.begin(), part.end());
    const auto picture = decode_png(bytes, {}, PngWarnings::are_errors);
    ASSERT_TRUE(picture) << picture.error().reason;
    EXPECT_EQ(picture->rgb, samples_of(3, 8));
  }
}

// zlib's checksum, the last 4 bytes of the data, in a chunk of its own: libpng has all pixels before it
// reads that. The encoder writes one IDAT; in front of it are its length and type, behind it CRC and IEND.
TEST(Png, WrongChecksumOfThePixelsIsAWarning) {
  const Bytes whole = encoded(3, 8);
  constexpr std::string_view kType = "IDAT";
  const auto type = std::search(whole.begin(), whole.end(), kType.begin(), kType.end());
  const auto data = type + 4, end = whole.end() - 12 - 4;
  ASSERT_LT(data, end - 4);
  const auto split = [&](std::uint8_t damage) {
    const Bytes pixels(data, end - 4);
    Bytes checksum(end - 4, end), bytes(whole.begin(), type - 4);
    checksum[3] ^= damage;
    for (const Bytes& part : {chunk("IDAT", pixels), chunk("IDAT", checksum), chunk("IEND", {})})
      bytes.insert(bytes.end(), part.begin(), part.end());
    return bytes;
  };
  EXPECT_TRUE(decode_png(split(0), {}, PngWarnings::are_errors));
  const auto ignored = decode_png(split(4));
  ASSERT_TRUE(ignored) << ignored.error().reason;
  EXPECT_EQ(ignored->rgb, samples_of(3, 8));
  const auto refused = decode_png(split(4), {}, PngWarnings::are_errors);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, Kind::damaged);
  EXPECT_FALSE(refused.error().reason.empty());
}

TEST(Png, DamagedBytesNeverDoHarm) {
  const Bytes whole = encoded(3, 8);
  Random random(5);
  for (int round = 0; round < 1000; ++round) {
    Bytes bytes = whole;
    for (int i = 0; i < 3; ++i)
      bytes[random.below(static_cast<std::uint32_t>(bytes.size()))] =
          static_cast<std::uint8_t>(random.below(256));
    const auto decoded = decode_png(bytes);
    if (decoded) {
      ASSERT_EQ(decoded->rgb.size(),
                static_cast<std::size_t>(decoded->width * decoded->height * 3));
    }
  }
}

}  // namespace
}  // namespace kaz::picture
