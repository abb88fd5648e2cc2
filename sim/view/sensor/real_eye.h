// One of the robot's cameras as its host receives it: rendered, distorted by lens and sensor, rectified.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "shared/base/result.hpp"
#include "sim/view/renderer.h"
#include "sim/view/sensor/sensor.h"
#include "vision/calibration/remap.h"
#include "vision/image/frame.h"

namespace kaz::sim {

// Draws and exposes only the part of a picture that the rectified picture uses.
class RealEye {
 public:
  // `noise_seed` as for Sensor.
  RealEye(const EyeModel& model, const vision::StereoCalibration& calibration, Sensor::Eye eye,
          std::uint64_t noise_seed);

  void set_noise_seed(std::uint64_t seed) { sensor_.set_noise_seed(seed); }
  // Returns the view for take(). `world_from_eye` is the pose of the mounting's optical frame, m.
  View view(const Eigen::Isometry3d& world_from_eye) const;
  // Takes the picture number `exposure`. `view` comes from view(), with the world's light. Errors as
  // Renderer::render().
  Result<void> take(Renderer& renderer, const ScenePose& pose, const View& view,
                    std::uint64_t exposure, vision::Image& rectified);

 private:
  Sensor sensor_;
  vision::Remap rectification_;
  Picture ideal_, raw_;  // reused memory of take()
};

}  // namespace kaz::sim
