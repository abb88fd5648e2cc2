// For tests: takes a picture of a scene with an eye that has lens, exposure and noise.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "sim/render/renderer.h"
#include "sim/render/sensor/sensor.h"
#include "vision/image/frame.h"

namespace kaz::sim {

// Takes a picture. `world_from_eye` is the world pose of the optical frame of the eye's mounting, m.
// `exposure` is the number of the exposure; the number determines the noise.
inline vision::Image take(Renderer& renderer, const ScenePose& pose, const Sensor& sensor,
                          const Eigen::Isometry3d& world_from_eye, std::uint64_t exposure) {
  View view;
  view.camera = sensor.ideal();
  view.world_from_optical = world_from_eye * sensor.mounting_from_optical();
  vision::Image ideal, picture;
  EXPECT_TRUE(renderer.render(pose, view, ideal));
  sensor.expose(ideal, exposure, picture);
  return picture;
}

}  // namespace kaz::sim
