// The capture module: adds the robot's posture at the exposure to each stereo pair.
// SPDX-License-Identifier: Apache-2.0
//
// This module is the first in the chain of vision modules (paper, section 4.1, "Frame Information
// Messaging"). The FrameInfo from this module accompanies all later results.
#pragma once

#include <deque>

#include "host/robot/robot.h"
#include "vision/image/frame.h"

namespace kaz::host {

class Capture final : public vision::Camera {
 public:
  // Maximum time that a pair waits for newer states from the board. A pair waits if its exposure is newer
  // than all states received so far. After this wait, poll() returns the pair with posture_known = false.
  static constexpr Time kPatience = std::chrono::milliseconds(50);

  // `camera` and `robot` must outlive this object and have the same time scale.
  Capture(vision::Camera& camera, Robot& robot) : camera_(camera), robot_(robot) {}

  const vision::CameraModel& model() const override { return camera_.model(); }

  // Returns the camera's next pair with `joint_rad`, `foot_from_eye` and `posture_known` set. If the camera
  // has failed, poll() first returns all waiting pairs, and then the camera's error.
  Result<std::optional<vision::StereoPair>> poll() override;

 private:
  vision::Camera& camera_;
  Robot& robot_;
  struct Arrived {
    vision::StereoPair pair;
    Time at{};
  };
  std::deque<Arrived> waiting_;
};

}  // namespace kaz::host
