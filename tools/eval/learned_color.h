// Learns the ball's color for an episode from a picture in different light.
// SPDX-License-Identifier: Apache-2.0
// Uses the same method as `kaz vision learn-color`.
#pragma once

#include "shared/base/result.hpp"
#include "tools/eval/scenario.h"
#include "tools/run/backend_options.h"
#include "vision/color/color.h"
#include "vision/color/color_learning.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// A picture as a user would take it before the episode, with the left eye's lens and noise. `region` is the
// part of the picture that the user would mark.
struct ColorLesson {
  // The ball lies in front of the robot on another floor; there are no other objects.
  Scenario scenario;
  vision::Image picture;
  vision::PictureRegion region;
};
// Draws a picture of a ball with the episode's paint and size. The lamp's azimuth differs by at least 90
// degrees from the azimuth in the episode. The lamp is as bright as in a default episode. Fails like
// make_simulation().
Result<ColorLesson> draw_color_lesson(const Scenario& episode, const BackendOptions& backend);
// Returns the range of colors to detect in the episode. Fails like draw_color_lesson(). Also fails if no
// color can be learned from the picture.
Result<vision::ColorRange> learned_ball_color(const Scenario& episode,
                                              const BackendOptions& backend);

}  // namespace kaz::tools
