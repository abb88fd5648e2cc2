// One of the robot's cameras. Renders, distorts and rectifies the picture that the host receives.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "shared/base/result.hpp"
#include "sim/render/renderer.h"
#include "sim/render/sensor/sensor.h"
#include "vision/calibration/remap.h"
#include "vision/image/frame.h"

namespace kaz::sim {

// Draws and exposes only those pixels of a picture that the rectified picture uses.
class RealEye {
 public:
  // `noise_seed` has the same meaning as in the constructor of Sensor.
  RealEye(const EyeModel& model, const vision::StereoCalibration& calibration, Sensor::Eye eye,
          std::uint64_t noise_seed);

  void set_noise_seed(std::uint64_t seed) { sensor_.set_noise_seed(seed); }
  // Returns the view for take(). `world_from_eye` is the pose (m) of the eye's mounting in the world frame;
  // the mounting has the axes of an optical frame.
  View view(const Eigen::Isometry3d& world_from_eye) const;
  // Takes a picture. The sequence number `exposure` selects the noise of the picture. `view` is the result of
  // view(). Before the call, the caller sets `view.light` to the light of the world. Returns the errors of
  // Renderer::render().
  Result<void> take(Renderer& renderer, const ScenePose& pose, const View& view,
                    std::uint64_t exposure, vision::Image& rectified);

 private:
  Sensor sensor_;
  vision::Remap rectification_;
  vision::Image ideal_, raw_;  // memory that take() reuses
};

}  // namespace kaz::sim
