// Colour extraction against the matrix, and the same mask from every kernel.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/color.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vision/image/pictures_testing.h"

namespace kaz::vision {
namespace {

TEST(Yiq, PrimariesByHand) {
  const Yiq red = yiq_from_rgb(255, 0, 0);
  EXPECT_NEAR(red.y, 76.2, 0.1);
  EXPECT_NEAR(red.i, 152.0, 0.1);
  EXPECT_NEAR(red.q, 53.8, 0.1);
  const Yiq white = yiq_from_rgb(255, 255, 255);
  EXPECT_NEAR(white.y, 255, 1e-9);
  EXPECT_NEAR(white.i, 0, 1e-9);
  EXPECT_NEAR(white.q, 0, 1e-9);
}

// What a range means, in real numbers; `margin` is how far inside (positive) a colour lies, in
// codes.
double margin(const ColorRange& range, double r, double g, double b) {
  const Yiq c = yiq_from_rgb(r, g, b);
  double m = std::min({c.y - range.y_min, range.y_max - c.y, c.i - range.i_min, range.i_max - c.i,
                       c.q - range.q_min, range.q_max - c.q});
  if (range.hue_min != 0 || range.hue_max != 0) {
    const double middle = 0.5 * (range.hue_min + range.hue_max);
    m = std::min({m, std::cos(range.hue_min) * c.q - std::sin(range.hue_min) * c.i,
                  std::sin(range.hue_max) * c.i - std::cos(range.hue_max) * c.q,
                  std::cos(middle) * c.i + std::sin(middle) * c.q - range.saturation_min * c.y});
  }
  return m;
}

TEST(ColorExtractor, FollowsItsRangeOverTheWholeCube) {
  ColorRange box;
  box.y_min = 40;
  box.y_max = 200;
  box.i_min = -20;
  box.i_max = 90;
  box.q_min = -30;
  box.q_max = 60;
  for (const ColorRange& range : {ColorRange::red_ball(), box, ColorRange{}}) {
    const ColorExtractor extractor(range);
    int inside = 0, outside = 0;
    for (int r = 0; r < 256; r += 5) {
      for (int g = 0; g < 256; g += 5) {
        for (int b = 0; b < 256; b += 5) {
          const double m = margin(range, r, g, b);
          // Three weights off by 1/250 of the largest each, the threshold by half a unit.
          if (std::abs(m) < 3.5) continue;
          ASSERT_EQ(extractor.contains(static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g),
                                       static_cast<std::uint8_t>(b)),
                    m > 0)
              << r << " " << g << " " << b;
          (m > 0 ? inside : outside)++;
        }
      }
    }
    EXPECT_GT(inside, 100);
    EXPECT_GE(outside, range.y_min > 0 ? 100 : 0);
  }
}

TEST(ColorExtractor, SumsOfHalfSpacesFitSixteenBits) {
  ColorRange range = ColorRange::red_ball();
  range.y_max = 250;
  range.i_min = -150;
  range.i_max = 150;
  range.q_min = -130;
  range.q_max = 130;
  const ColorExtractor extractor(range);
  EXPECT_EQ(extractor.half_spaces().size(), 9U);
  for (const auto& h : extractor.half_spaces()) {
    int high = 0, low = 0;
    for (const int w : {h.r, h.g, h.b}) (w > 0 ? high : low) += 255 * w;
    EXPECT_LE(high, 32767);
    EXPECT_GE(low, -32768);
  }
}

TEST(ColorExtractor, RedBallInAnyLightAndNothingElse) {
  const ColorExtractor red(ColorRange::red_ball());
  for (const double light : {1.0, 0.7, 0.4, 0.25}) {
    const auto code = [light](double c) {
      return static_cast<std::uint8_t>(std::lround(c * light));
    };
    EXPECT_TRUE(red.contains(code(217), code(20), code(15))) << light;
    EXPECT_TRUE(red.contains(code(255), code(0), code(0))) << light;
    EXPECT_TRUE(red.contains(code(190), code(30), code(45))) << light;  // a real ball, bluish light
  }
  const std::uint8_t others[][3] = {{255, 140, 0},   {204, 148, 92},  {255, 0, 255},
                                    {230, 170, 150}, {255, 255, 0},   {0, 0, 255},
                                    {0, 255, 0},     {128, 128, 128}, {255, 255, 255},
                                    {0, 0, 0},       {120, 80, 60},   {255, 180, 190}};
  for (const auto& c : others) {
    EXPECT_FALSE(red.contains(c[0], c[1], c[2])) << +c[0] << " " << +c[1] << " " << +c[2];
  }
}

TEST(ColorExtractor, EveryKernelGivesTheSameMask) {
  TestRandom random(1);
  for (const auto& [width, height] :
       {std::pair{1, 1}, {7, 3}, {16, 1}, {33, 31}, {513, 5}, {320, 240}}) {
    Image image{width, height, {}};
    image.rgb.resize(static_cast<std::size_t>(width * height) * 3);
    for (std::uint8_t& c : image.rgb) c = static_cast<std::uint8_t>(random.next());
    ColorRange range = ColorRange::red_ball();
    range.saturation_min = 0.2;
    const ColorExtractor extractor(range);
    Mask fast, plain;
    extractor.extract(image, fast);
    extractor.extract(image, plain, false);
    EXPECT_EQ(fast.pixels, plain.pixels);
    ASSERT_EQ(fast.pixels.size(), static_cast<std::size_t>(width * height));
    for (std::size_t i = 0; i < fast.pixels.size(); ++i) {
      const bool in =
          extractor.contains(image.rgb[3 * i], image.rgb[3 * i + 1], image.rgb[3 * i + 2]);
      ASSERT_EQ(fast.pixels[i], in ? 255 : 0);
    }
  }
}

TEST(ColorExtractor, DamagedImagesGiveShortMasks) {
  const ColorExtractor extractor(ColorRange::red_ball());
  Mask mask;
  extractor.extract(Image{}, mask);
  EXPECT_TRUE(mask.pixels.empty());
  extractor.extract(Image{-3, 5, {}}, mask);
  EXPECT_TRUE(mask.pixels.empty());
  extractor.extract(Image{100, 100, std::vector<std::uint8_t>(30)}, mask);
  EXPECT_EQ(mask.pixels.size(), 10U);  // never reads past what there is
}

}  // namespace
}  // namespace kaz::vision
