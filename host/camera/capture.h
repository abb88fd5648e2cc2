// The capture module: stamps each stereo pair with the posture of the robot when it was exposed.
// SPDX-License-Identifier: Apache-2.0
//
// First in the chain of vision modules (paper, section 4.1, "Frame Information Messaging"): its FrameInfo
// accompanies every later result.
#pragma once

#include <deque>

#include "host/robot/robot.h"
#include "vision/image/frame.h"

namespace kaz::host {

class Capture final : public vision::Camera {
 public:
  // A pair whose exposure is newer than every state read from the board waits for a newer state,
  // but not longer than this; then it goes on with posture_known = false.
  static constexpr Time kPatience = std::chrono::milliseconds(50);

  // Camera and robot must outlive this. Their time scales must be the same.
  Capture(vision::Camera& camera, Robot& robot) : camera_(camera), robot_(robot) {}

  const vision::CameraModel& model() const override { return camera_.model(); }

  // The camera's next pair with `joint_rad`, `foot_from_eye` and `posture_known` filled in. Errors
  // are the camera's.
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
