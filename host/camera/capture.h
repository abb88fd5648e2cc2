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
  // If the exposure of a pair is newer than all states from the board, the pair waits at most this long for
  // newer states. After this wait, poll() returns the pair with posture_known = false.
  static constexpr Time kPatience = std::chrono::milliseconds(50);

  // `camera` and `robot` must outlive this object and have the same time scale.
  Capture(vision::Camera& camera, Robot& robot) : camera_(camera), robot_(robot) {}

  const vision::CameraModel& model() const override { return camera_.model(); }

  // Returns the camera's next pair with `joint_rad`, `foot_from_eye` and `posture_known` set. Returns the
  // camera's error once all waiting pairs were returned.
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
