// Colours learned from a region find the ball they were learned from, whatever its hue.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/color_learning.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shared/base/random.hpp"
#include "vision/color/ball.h"
#include "vision/image/pictures_testing.h"

namespace kaz::vision {
namespace {

// A ball at 0.3 m before a grey wall, darker towards the bottom, with noise of 4 codes.
struct Scene {
  CameraModel camera = test_camera();
  Image image;
  double u = 190, v = 130, radius_px = 0;

  explicit Scene(const TestColor& color, std::uint64_t seed = 1) {
    image = plain_picture(camera.width, camera.height, kTestGrey);
    const Eigen::Vector3d center =
        0.3 *
        Eigen::Vector3d((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1).normalized();
    paint_sphere(image, camera, center, 0.020, color);
    radius_px = camera.fx * 0.020 / 0.3;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
      const double row = static_cast<double>(i / 3 / static_cast<std::size_t>(camera.width));
      const double shade = 1 - 0.5 * row / camera.height;
      const double code = image.rgb[i] * shade + 4 * keyed_normal(seed, i, 0);
      image.rgb[i] = static_cast<std::uint8_t>(std::clamp(code, 0.0, 255.0));
    }
  }
  PictureRegion around(double share) const {
    const int half = static_cast<int>(share * radius_px);
    return {static_cast<int>(u) - half, static_cast<int>(v) - half, 2 * half + 1, 2 * half + 1};
  }
};

TEST(LearnColor, FindsBallsOfManyHues) {
  // The last two lie on both sides of where atan2 jumps.
  for (const TestColor& color :
       {TestColor{215, 25, 20}, TestColor{30, 160, 50}, TestColor{30, 60, 190},
        TestColor{230, 140, 20}, TestColor{150, 40, 160}, TestColor{20, 150, 170},
        TestColor{20, 150, 200}}) {
    const Scene scene(color);
    const auto learned = learn_color(scene.image, scene.around(0.6));
    ASSERT_TRUE(learned) << learned.error().message;
    EXPECT_GT(learned->inside, 0.95) << color.r << " " << color.g;
    // The rest of the disc is 1 % of the picture; the wall stays out.
    EXPECT_LT(learned->outside, 0.01) << color.r << " " << color.g;
    // Another picture of the same ball, other noise.
    const Scene other(color, 2);
    BallOptions options;
    options.color = learned->range;
    const BallObservation ball = BallFinder(options).detect(other.image, test_info(other.camera));
    ASSERT_TRUE(ball.found) << color.r << " " << color.g;
    EXPECT_NEAR(ball.center_u, other.u, 0.5);
    EXPECT_NEAR(ball.center_v, other.v, 0.5);
    EXPECT_NEAR(ball.distance_m, 0.3, 0.03 * 0.3);
  }
}

TEST(LearnColor, SomeBackgroundInTheRegionDoesNotMatter) {
  const Scene scene(kTestRed);
  // A square around the whole disc: a fifth of it is wall.
  const auto learned = learn_color(scene.image, scene.around(1.0));
  ASSERT_TRUE(learned) << learned.error().message;
  EXPECT_GT(learned->inside, 0.7);
  EXPECT_LT(learned->outside, 0.001);
}

TEST(LearnColor, RefusesWhatHasNoColourOfItsOwn) {
  const Scene scene(kTestRed);
  const auto message = [&](const Image& image, const PictureRegion& region) {
    const auto learned = learn_color(image, region);
    return learned ? std::string("learned") : learned.error().message;
  };
  const auto holds = [](const std::string& text, const char* word) {
    return text.find(word) != std::string::npos;
  };
  EXPECT_TRUE(holds(message(scene.image, {10, 10, 40, 40}), "gray"));
  EXPECT_TRUE(holds(message(scene.image, {310, 10, 40, 40}), "not within"));
  EXPECT_TRUE(holds(message(scene.image, {-1, 10, 40, 40}), "not within"));
  EXPECT_TRUE(holds(message(scene.image, {5, 5, 2147483647, 2147483647}), "not within"));
  EXPECT_TRUE(holds(message(scene.image, {10, 10, 4, 4}), "fewer than 25"));
  EXPECT_TRUE(holds(message({}, {0, 0, 10, 10}), "empty"));
  EXPECT_TRUE(holds(message(plain_picture(40, 40, {0, 0, 0}), {0, 0, 40, 40}), "black"));
  // Three stripes of hues far apart: none has half.
  Image stripes = plain_picture(60, 20, {200, 20, 20});
  for (int v = 0; v < 20; ++v) {
    for (int u = 20; u < 60; ++u) {
      std::uint8_t* p = &stripes.rgb[static_cast<std::size_t>(v * 60 + u) * 3];
      p[0] = 20;
      p[1] = u < 40 ? 200 : 20;
      p[2] = u < 40 ? 20 : 200;
    }
  }
  EXPECT_TRUE(holds(message(stripes, {0, 0, 60, 20}), "several colors"));
}

TEST(LearnColor, SeveralPicturesGiveOneRangeForAll) {
  const TestColor colors[] = {{230, 140, 20}, {190, 190, 40}, {20, 150, 170}, {20, 150, 200}};
  const auto marked = [&](std::size_t i) {
    const Scene scene(colors[i]);
    return MarkedPicture{"picture " + std::to_string(i), scene.image, scene.around(0.6)};
  };
  // The last two lie on both sides of where atan2 jumps.
  for (const auto& [first, second] : {std::pair<std::size_t, std::size_t>{0, 1}, {2, 3}, {3, 2}}) {
    const std::vector<MarkedPicture> pictures{marked(first), marked(second)};
    const auto both = learn_color(pictures);
    ASSERT_TRUE(both) << both.error().message;
    EXPECT_GT(both->inside, 0.95);
    const ColorExtractor extractor(both->range);
    for (const MarkedPicture& picture : pictures) {
      const auto alone = learn_color(picture.image, picture.region);
      EXPECT_LE(both->range.saturation_min, alone->range.saturation_min);
      const std::uint8_t* p =
          &picture.image.rgb[static_cast<std::size_t>(130 * picture.image.width + 190) * 3];
      EXPECT_TRUE(extractor.contains(p[0], p[1], p[2])) << picture.name;
    }
    EXPECT_LT(both->range.hue_max - both->range.hue_min, 1.5);
  }
}

TEST(LearnColor, SeveralPicturesNameTheBadOne) {
  const Scene red(kTestRed), blue({30, 60, 190});
  const MarkedPicture good{"a.png", red.image, red.around(0.6)};
  const std::vector<MarkedPicture> outside{good, {"b.png", red.image, {310, 10, 40, 40}}};
  const auto refused = learn_color(outside);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.rfind("b.png: the region", 0), 0u) << refused.error().message;
  const std::vector<MarkedPicture> apart{good,
                                         {"c.png", blue.image, blue.around(0.6)},
                                         {"d.png", Scene({30, 160, 50}).image, blue.around(0.6)}};
  const auto wide = learn_color(apart);
  ASSERT_FALSE(wide);
  EXPECT_NE(wide.error().message.find("differs too much"), std::string::npos);
  EXPECT_FALSE(learn_color(std::span<const MarkedPicture>{}));
}

}  // namespace
}  // namespace kaz::vision
