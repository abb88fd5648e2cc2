// For tests: picture of a scene by an eye with lens, exposure and noise.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "sim/view/renderer.h"
#include "sim/view/sensor/sensor.h"
#include "vision/image/frame.h"

namespace kaz::sim {

// `world_from_eye`: of the nominal optical frame, m. The noise is that of exposure number `exposure`.
inline vision::Image take(Renderer& renderer, const ScenePose& pose, const Sensor& sensor,
                          const Eigen::Isometry3d& world_from_eye, std::uint64_t exposure) {
  View view;
  view.camera = sensor.ideal();
  view.world_from_optical = world_from_eye * sensor.mounting_from_optical();
  Picture ideal, picture;
  EXPECT_TRUE(renderer.render(pose, view, ideal));
  sensor.expose(ideal, exposure, picture);
  return {picture.width, picture.height, picture.rgb};
}

}  // namespace kaz::sim
