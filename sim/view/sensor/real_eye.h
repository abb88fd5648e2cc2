// One of the robot's cameras as its host gets it: drawn, through lens and sensor, rectified.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "shared/base/result.hpp"
#include "sim/view/renderer.h"
#include "sim/view/sensor/sensor.h"
#include "vision/calibration/remap.h"
#include "vision/image/frame.h"

namespace kaz::sim {

// Of the pictures before rectification only that part is drawn and exposed which the rectified one is made
// of.
class RealEye {
 public:
  // `noise_seed`: as Sensor has it.
  RealEye(const EyeModel& model, const vision::StereoCalibration& calibration, Sensor::Eye eye,
          std::uint64_t noise_seed);

  void set_noise_seed(std::uint64_t seed) { sensor_.set_noise_seed(seed); }
  // `world_from_eye`: of the mounting's optical frame, m.
  View view(const Eigen::Isometry3d& world_from_eye) const;
  // `view`: by view(), and the light. Error: the renderer's.
  Result<void> take(Renderer& renderer, const ScenePose& pose, const View& view,
                    std::uint64_t exposure, vision::Image& rectified);

 private:
  Sensor sensor_;
  vision::Remap rectification_;
  Picture ideal_, raw_;  // of the last call
};

}  // namespace kaz::sim
