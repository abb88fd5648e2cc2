// An episode's colour is learned in another light, and is that of its ball.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/learned_color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kaz::tools {
namespace {

TEST(ColorLesson, IsInAnotherLightAndTeachesTheBallsColourAlone) {
  Variation variation;
  variation.colors = {"red", "green", "blue"};
  BackendOptions backend;
  backend.eyes = sim::EyeKind::real;
  for (std::uint64_t number = 0; number < 9; ++number) {
    const Scenario episode = Scenario::draw(variation, 5, number);
    const auto lesson = draw_color_lesson(episode, backend);
    ASSERT_TRUE(lesson) << lesson.error().message;
    EXPECT_LT(std::cos(lesson->scenario.lamp_azimuth_rad - episode.lamp_azimuth_rad), 1e-9);
    EXPECT_NE(lesson->scenario.floor, episode.floor);
    const auto learned = vision::learn_color(lesson->picture, lesson->region);
    ASSERT_TRUE(learned) << learned.error().message;
    EXPECT_GT(learned->inside, 0.95) << episode.ball_color;
    EXPECT_LT(learned->outside, 0.01) << "the ball alone has the colour";
    // Its own paint in whatever light, and no other ball's.
    for (const BallColor& color : ball_colors()) {
      const vision::Yiq paint =
          vision::yiq_from_rgb(255 * color.rgb[0], 255 * color.rgb[1], 255 * color.rgb[2]);
      const double middle = 0.5 * (learned->range.hue_min + learned->range.hue_max);
      const double off =
          std::abs(std::remainder(std::atan2(paint.q, paint.i) - middle, 2 * std::numbers::pi));
      if (color.name == episode.ball_color) {
        EXPECT_LT(off, 0.3) << color.name;
      } else {
        EXPECT_GT(off, 0.6) << color.name;
      }
    }
  }
}

TEST(ColorLesson, IsTheSameForTheSameEpisode) {
  const Scenario episode = Scenario::draw({}, 5, 1);
  const auto once = draw_color_lesson(episode, {}), again = draw_color_lesson(episode, {});
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->picture.rgb, again->picture.rgb);
}

}  // namespace
}  // namespace kaz::tools
