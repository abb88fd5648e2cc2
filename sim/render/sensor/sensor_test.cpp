// Noise by its law, the same bytes on all paths, and what the eyes' pictures cover.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/sensor/sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shared/base/random.hpp"
#include "sim/render/scenes_testing.h"
#include "vision/calibration/rectify.h"

namespace kaz::sim {
namespace {

struct Moments {
  double mean = 0, sigma = 0;
};

Moments moments_of(const std::vector<std::uint8_t>& codes) {
  const auto n = static_cast<double>(codes.size());
  const double mean = std::accumulate(codes.begin(), codes.end(), 0.0) / n;
  double squares = 0;
  for (const auto code : codes) squares += (code - mean) * (code - mean);
  return {mean, std::sqrt(squares / n)};
}

std::vector<std::uint8_t> exposed(const NoiseLaw& law, double code, std::uint64_t key,
                                  std::size_t count = 100'000) {
  const std::vector<std::uint16_t> codes64(count,
                                           static_cast<std::uint16_t>(std::lround(64 * code)));
  std::vector<std::uint8_t> codes(count);
  NoiseRow(law).expose(codes64.data(), codes.data(), {0, count}, key);
  return codes;
}

TEST(SensorNoise, HasTheSigmaOfItsElectrons) {
  const NoiseLaw law;
  for (const double code : {30.0, 60.0, 120.0, 200.0}) {
    // n electrons of the full well; the code is the root of the light: dc = c dn / 2n.
    const double n = law.full_well_e * code * code / (255 * 255);
    const double sigma = code / (2 * n) * std::sqrt(n + law.read_noise_e * law.read_noise_e);
    const Moments m = moments_of(exposed(law, code, 7));
    EXPECT_NEAR(m.mean, code, 0.15) << code;  // the root is concave: sigma^2 / 2c lower
    // 1/12 is the variance of rounding. Sampling 100,000 leaves 0.3 %, the root's curve 2 % more.
    EXPECT_NEAR(m.sigma, std::sqrt(sigma * sigma + 1.0 / 12), 0.025 * m.sigma) << code;
  }
}

TEST(SensorNoise, ExposureMultipliesLight) {
  NoiseLaw law;
  law.exposure = 0.25;
  EXPECT_NEAR(moments_of(exposed(law, 200, 1)).mean, 100, 0.1);
  law.exposure = 4;
  EXPECT_GT(moments_of(exposed(law, 200, 1)).mean, 254.9);  // full
}

TEST(SensorNoise, NeighboursRowsAndExposuresAreIndependent) {
  const NoiseLaw law;
  const auto correlation = [](const std::vector<std::uint8_t>& a,
                              const std::vector<std::uint8_t>& b, std::size_t shift) {
    const Moments ma = moments_of(a), mb = moments_of(b);
    double sum = 0;
    for (std::size_t i = shift; i < a.size(); ++i)
      sum += (a[i] - ma.mean) * (b[i - shift] - mb.mean);
    return sum / static_cast<double>(a.size() - shift) / (ma.sigma * mb.sigma);
  };
  const auto a = exposed(law, 120, 1), b = exposed(law, 120, 2);
  // Sigma of a correlation of 100,000: 0.0032.
  EXPECT_NEAR(correlation(a, b, 0), 0, 0.012);
  for (const std::size_t shift : {1u, 3u, 16u, 32u, 960u})
    EXPECT_NEAR(correlation(a, a, shift), 0, 0.012) << shift;
}

TEST(SensorNoise, IsTheSameOnEveryPath) {
  const NoiseRow noise{NoiseLaw{}};
  for (const std::size_t count : {1u, 15u, 480u, 960u, 1001u, 1920u}) {
    std::vector<std::uint16_t> codes64(count);
    for (std::size_t i = 0; i < count; ++i)
      codes64[i] = static_cast<std::uint16_t>(mix64(i) % (64 * 255));
    std::vector<std::uint8_t> plain(count);
    noise.expose(codes64.data(), plain.data(), {0, count}, 99, InstructionSet::plain);
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_available(set)) continue;
      std::vector<std::uint8_t> fast(count);
      noise.expose(codes64.data(), fast.data(), {0, count}, 99, set);
      EXPECT_EQ(fast, plain) << count << " " << static_cast<int>(set);
    }
  }
}

// Code 77, which no value of the row has, stays outside of the range.
TEST(SensorNoise, PartsOfARowAreThoseOfTheWhole) {
  const NoiseRow noise{NoiseLaw{}};
  const std::vector<std::uint16_t> codes64(200, 64 * 20);
  std::vector<std::uint8_t> whole(codes64.size());
  noise.expose(codes64.data(), whole.data(), {0, whole.size()}, 3);
  ASSERT_EQ(std::count(whole.begin(), whole.end(), 77), 0);
  for (const NoiseRow::Range range :
       {NoiseRow::Range{0, 5}, {3, 16}, {16, 32}, {17, 18}, {31, 117}, {64, 200}}) {
    std::vector<std::uint8_t> expected(whole.size(), 77);
    const std::vector<std::uint8_t> before = expected;
    std::copy(whole.data() + range.first, whole.data() + range.end, expected.data() + range.first);
    for (const InstructionSet set :
         {InstructionSet::plain, InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_available(set)) continue;
      std::vector<std::uint8_t> part = before;
      noise.expose(codes64.data(), part.data(), range, 3, set);
      EXPECT_EQ(part, expected) << range.first << " " << static_cast<int>(set);
    }
  }
}

TEST(Sensor, TheSameSeedAndExposureGiveTheSameBytes) {
  const EyeModel model;
  const auto calibration = make_calibration(model, 1, 0.04);
  const Sensor sensor(model, calibration, Sensor::Eye::left, 5);
  vision::Image ideal{sensor.ideal().width, sensor.ideal().height, {}}, a, b;
  ideal.rgb.assign(static_cast<std::size_t>(ideal.width * ideal.height) * 3, 140);
  sensor.expose(ideal, 12, a);
  Sensor(model, calibration, Sensor::Eye::left, 5).expose(ideal, 12, b);
  EXPECT_EQ(a.rgb, b.rgb);
  sensor.expose(ideal, 13, b);
  EXPECT_NE(a.rgb, b.rgb);
  Sensor(model, calibration, Sensor::Eye::right, 5).expose(ideal, 12, b);
  EXPECT_NE(a.rgb, b.rgb);
}

// Of an ideal picture without what lies outside of ideal_part(), and exposed only where rectification looks.
TEST(Sensor, WhatALimitLeavesOutRectifiedPicturesDoNotShow) {
  const EyeModel model;
  for (std::uint64_t unit = 1; unit <= 5; ++unit) {
    const auto calibration = make_calibration(model, unit, 0.04);
    const vision::Remap remap = vision::rectification(calibration, calibration.right);
    Sensor sensor(model, calibration, Sensor::Eye::right, 5);
    vision::Image ideal{sensor.ideal().width, sensor.ideal().height, {}}, all, limited;
    Random random(unit);
    for (int i = 0; i < ideal.width * ideal.height * 3; ++i)
      ideal.rgb.push_back(static_cast<std::uint8_t>(random.below(256)));
    sensor.expose(ideal, 3, all);
    sensor.limit(remap.sources(remap.all_rows()));
    const PicturePart part = sensor.ideal_part();
    for (int v = 0, i = 0; v < ideal.height; ++v) {
      for (int u = 0; u < ideal.width; ++u) {
        const bool outside = u < part.left || u >= part.right || v < part.top || v >= part.bottom;
        for (int c = 0; c < 3; ++c, ++i) {
          if (outside) ideal.rgb[static_cast<std::size_t>(i)] ^= 0xFF;
        }
      }
    }
    sensor.expose(ideal, 3, limited);
    EXPECT_NE(all.rgb, limited.rgb);
    std::vector<std::uint8_t> expected, rectified;
    remap.apply(all.rgb, expected);
    remap.apply(limited.rgb, rectified);
    EXPECT_TRUE(rectified == expected) << unit;
    // Of 80 degrees at 0.92 of the resolution, and what tolerances add.
    EXPECT_LT((part.right - part.left) * (part.bottom - part.top),
              0.8 * ideal.width * ideal.height);
  }
}

TEST(Sensor, CornersAreDarkerByTheVignetting) {
  EyeModel model;
  model.centre_spread = 0;
  const Sensor sensor(model, make_calibration(model, 1, 0.04), Sensor::Eye::left, 1);
  vision::Image ideal{sensor.ideal().width, sensor.ideal().height, {}}, bent;
  ideal.rgb.assign(static_cast<std::size_t>(ideal.width * ideal.height) * 3, 200);
  sensor.bend(ideal, bent);
  EXPECT_EQ(bent.rgb[(120 * 320 + 160) * 3], 200);
  EXPECT_NEAR(bent.rgb[0], 200 * std::sqrt(0.7), 1.5);  // light c^2, 0.7 of it
}

// Whatever the copy of the cameras: a lens that sees less than the rectified picture would leave
// black edges there.
TEST(Sensor, RectifiedPicturesAreFull) {
  const EyeModel model;
  double full = 0, all = 0;
  for (std::uint64_t unit = 1; unit <= 40; ++unit) {
    const auto calibration = make_calibration(model, unit, 0.04);
    vision::StereoImages raw, rectified;
    raw.left = {320, 240, std::vector<std::uint8_t>(320 * 240 * 3, 200)};
    raw.right = raw.left;
    vision::Rectifier(calibration).rectify(raw, rectified);
    for (const auto* image : {&rectified.left, &rectified.right}) {
      for (const auto code : image->rgb) full += code > 0 ? 1 : 0;
      all += static_cast<double>(image->rgb.size());
    }
  }
  // A centre off by 1.3 px, a direction by 0.8 px and so on, together 1.7 px (one sigma), against a
  // margin of 4 px above and below: single rows of some copies stay black.
  EXPECT_GT(full / all, 0.998);
}

TEST(Calibration, CopiesDifferAndAUnitIsAlwaysTheSame) {
  const EyeModel model;
  const auto one = make_calibration(model, 1, 0.04), same = make_calibration(model, 1, 0.04);
  EXPECT_EQ(one.left.lens.fx, same.left.lens.fx);
  EXPECT_NE(one.left.lens.fx, one.right.lens.fx);
  EXPECT_NE(one.left.lens.cx, make_calibration(model, 2, 0.04).left.lens.cx);
  EXPECT_NEAR(one.left.lens.fx, 195.1, 2.2);  // 160 px at the bent edge of 42.75 degrees
}

}  // namespace
}  // namespace kaz::sim
