// Learns the ball's color for an episode as `kaz vision learn-color` does, from a picture in different light.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "tools/app/evaluate/scenario.h"
#include "tools/app/session/backend_options.h"
#include "vision/color/color.h"
#include "vision/color/color_learning.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// Picture as a user takes it before the episode, with the left eye's lens and noise, and the region marked in
// it.
struct ColorLesson {
  Scenario scenario;  // the ball in front of the robot on another floor, and no other objects
  vision::Image picture;
  vision::PictureRegion region;
};
// Draws a picture of a ball with the episode's paint and size. The lamp is at least 90 degrees from that of
// the episode in azimuth, and as bright as in a default episode. Errors as make_simulation().
Result<ColorLesson> draw_color_lesson(const Scenario& episode, const BackendOptions& backend);
// Returns the color range to detect in the episode. Also fails if no color can be learned from the picture.
Result<vision::ColorRange> learned_ball_color(const Scenario& episode,
                                              const BackendOptions& backend);

}  // namespace kaz::tools
