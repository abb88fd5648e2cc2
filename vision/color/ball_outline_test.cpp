// Outlines of balls in pixels, on painted pictures with shading, highlights, noise and other objects.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/ball_outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shared/base/random.hpp"
#include "vision/image/pictures_testing.h"

namespace kaz::vision {
namespace {

constexpr TestColor kYellow{200, 180, 60}, kGreen{40, 110, 60}, kBlack{12, 12, 14};

// Yellow on a green floor.
struct OutlineScene {
  Image image = plain_picture(200, 160, kGreen);

  void set(int u, int v, const TestColor& color, double share, double light) {
    std::uint8_t* p = &image.rgb[static_cast<std::size_t>(v * image.width + u) * 3];
    const double target[3] = {color.r, color.g, color.b};
    for (int c = 0; c < 3; ++c)
      p[c] = static_cast<std::uint8_t>(
          std::clamp(p[c] + share * (light * target[c] - p[c]), 0.0, 255.0));
  }
  // A ball that is lit from above. Its picture is `oval` times as wide as high.
  void add_ball(double u0, double v0, double radius, double oval = 1,
                const TestColor& color = kYellow) {
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        const double du = (u - u0) / std::sqrt(oval), dv = (v - v0) * std::sqrt(oval);
        const double share = std::clamp(radius + 0.5 - std::hypot(du, dv), 0.0, 1.0);
        if (share > 0) set(u, v, color, share, 1 - 0.35 * dv / radius);
      }
    }
  }
  void add_box(int left, int top, int right, int bottom, const TestColor& color) {
    for (int v = top; v < bottom; ++v)
      for (int u = left; u < right; ++u) set(u, v, color, 1, 1);
  }
  void add_noise() {
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
      image.rgb[i] = static_cast<std::uint8_t>(
          std::clamp(image.rgb[i] + 4 * keyed_normal(1, i, 0), 0.0, 255.0));
  }
  std::vector<BallOutline> balls() {
    add_noise();
    OutlineOptions options;
    options.color = {};
    options.color.y_min = 25;
    options.color.hue_min = -1.4;
    options.color.hue_max = -0.2;
    options.color.saturation_min = 0.15;
    return OutlineFinder(options).find(image);
  }
};

void expect_ball(const BallOutline& ball, double u, double v, double radius, double tolerance_px) {
  EXPECT_NEAR(ball.center_u, u, tolerance_px);
  EXPECT_NEAR(ball.center_v, v, tolerance_px);
  EXPECT_NEAR(ball.radius_px, radius, tolerance_px);
}

TEST(OutlineFinder, FindsShadedBallsOfManySizes) {
  for (const double radius : {9.0, 14.0, 25.0, 45.0}) {
    OutlineScene scene;
    scene.add_ball(100.3, 80.6, radius);
    const auto balls = scene.balls();
    ASSERT_EQ(balls.size(), 1u) << radius;
    expect_ball(balls[0], 100.3, 80.6, radius, 0.4);
  }
}

TEST(OutlineFinder, FindsABallHiddenInPart) {
  OutlineScene scene;
  scene.add_ball(100, 80, 25);
  scene.add_box(113, 40, 150, 120, kBlack);  // a fifth of the ball
  const auto balls = scene.balls();
  ASSERT_EQ(balls.size(), 1u);
  expect_ball(balls[0], 100, 80, 25, 2);
}

TEST(OutlineFinder, FindsABallCutOffByThePicture) {
  OutlineScene scene;
  scene.add_ball(100, 152, 30);
  const auto balls = scene.balls();
  ASSERT_EQ(balls.size(), 1u);
  expect_ball(balls[0], 100, 152, 30, 2);
}

TEST(OutlineFinder, FindsTheOvalOfAWideAngleLens) {
  OutlineScene scene;
  scene.add_ball(100, 80, 30, 1.25);
  const auto balls = scene.balls();
  ASSERT_EQ(balls.size(), 1u);
  expect_ball(balls[0], 100, 80, 30, 1);
  EXPECT_NEAR(balls[0].radius_at(1, 0) / balls[0].radius_at(0, 1), 1.25, 0.06);
}

TEST(OutlineFinder, FindsABallWithAWhiteHighlight) {
  OutlineScene scene;
  scene.add_ball(100, 80, 25);
  scene.add_ball(98, 68, 10, 1, {250, 245, 235});
  const auto balls = scene.balls();
  ASSERT_EQ(balls.size(), 1u);
  expect_ball(balls[0], 100, 80, 25, 1);
}

TEST(OutlineFinder, FindsAllBallsBestFirst) {
  OutlineScene scene;
  scene.add_ball(50, 50, 20);
  scene.add_box(62, 0, 90, 160, kBlack);
  scene.add_ball(140, 100, 20);
  const auto balls = scene.balls();
  ASSERT_EQ(balls.size(), 2u);
  expect_ball(balls[0], 140, 100, 20, 0.5);
  expect_ball(balls[1], 50, 50, 20, 2);
  EXPECT_GT(balls[0].confidence, balls[1].confidence);
}

TEST(OutlineFinder, OtherShapesAreNoBalls) {
  for (const auto& [right, bottom] : {std::pair{170, 50}, {60, 140}, {75, 75}}) {
    OutlineScene scene;
    scene.add_box(30, 30, right, bottom, kYellow);
    EXPECT_TRUE(scene.balls().empty()) << right << " " << bottom;
  }
}

TEST(OutlineFinder, ASmallPartOfAWallIsNoBall) {
  OutlineScene scene;
  scene.add_box(0, 0, 200, 80, kYellow);
  scene.add_box(0, 0, 200, 50, kBlack);
  EXPECT_TRUE(scene.balls().empty());
}

TEST(OutlineFinder, HostilePicturesHaveNoBalls) {
  OutlineFinder finder({});
  EXPECT_TRUE(finder.find({}).empty());
  EXPECT_TRUE(finder.find({320, 240, std::vector<std::uint8_t>(100)}).empty());
  EXPECT_TRUE(finder.find({-1, -1, std::vector<std::uint8_t>(3)}).empty());
  for (const int size : {1, 2, 3, 20})
    EXPECT_TRUE(finder.find(plain_picture(size, size, kTestRed)).empty()) << size;
}

TEST(OutlineConfidence, GrowsWithEvidence) {
  const OutlineEvidence good{1, 1, 1, 1, 1, 0.2};
  EXPECT_GT(outline_confidence(good, 20), 0.95);
  EXPECT_GT(outline_confidence(good, 20), outline_confidence(good, 5));
  for (double OutlineEvidence::*member :
       {&OutlineEvidence::arc, &OutlineEvidence::filled, &OutlineEvidence::isolated,
        &OutlineEvidence::covers, &OutlineEvidence::shading}) {
    OutlineEvidence worse = good;
    worse.*member -= 0.3;
    EXPECT_LT(outline_confidence(worse, 20), outline_confidence(good, 20));
  }
  OutlineEvidence short_part = good;
  short_part.support = 0.29;
  EXPECT_EQ(outline_confidence(short_part, 20), 0);
}

}  // namespace
}  // namespace kaz::vision
