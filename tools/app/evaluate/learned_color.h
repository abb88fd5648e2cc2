// The ball's colour of an episode, learned as by `kaz vision learn-color`, from a picture in another light.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "tools/app/evaluate/scenario.h"
#include "tools/app/session/backend_options.h"
#include "vision/color/color.h"
#include "vision/color/color_learning.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// The picture that somebody took before the episode, of the left eye with its lens and noise, and what they
// marked in it.
struct ColorLesson {
  Scenario scenario;  // the ball before the robot on another floor, nothing else
  vision::Image picture;
  vision::PictureRegion region;
};
// The lamp is at least 90 degrees aside from that of the episode, and as bright as in any usual one. Of the
// episode there are the ball's paint and size. Errors: as make_simulation().
Result<ColorLesson> draw_color_lesson(const Scenario& episode, const BackendOptions& backend);
// What vision looks for in the episode. Errors also: no colour can be learned from the picture.
Result<vision::ColorRange> learned_ball_color(const Scenario& episode,
                                              const BackendOptions& backend);

}  // namespace kaz::tools
