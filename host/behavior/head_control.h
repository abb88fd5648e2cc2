// Head control for behaviors: sends one target per control cycle, tracks the ball and logs all images.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/behavior/ball_tracker.h"
#include "host/behavior/control_cycle.h"
#include "host/robot/kinematics.h"

namespace kaz::behavior {

class HeadControl {
 public:
  // Lag of the position loop behind a target that moves at constant speed. The loop sets duty = kp error - kd
  // rate. An unloaded motor runs at rate = duty w0, with w0 = 11.46 rad/s at 10 V. Hence
  //   error / rate = (kd + 1/w0) / kp = (0.15 + 1/11.46) / 20 = 12 ms.
  static constexpr Time kServoLag = std::chrono::milliseconds(12);
  // Time from the decision on a target until the head reaches the target: the sum of sending, ramp and servo
  // lag.
  static constexpr Time kLead = ControlCycle::kSendDelay + ControlCycle::kRamp + kServoLag;
  static constexpr double kMargin = 0.017;  // minimum distance of targets to joint limits, rad

  // Enables the motors at their present angles and reads the first state. Fails (usage) without a camera. The
  // context must outlive the returned object.
  static Result<HeadControl> begin(Context& context, std::string_view behavior);

  void phase(std::string_view phase) { context_->sink.phase(now(), behavior_, phase); }
  // Clamps a target to the joints' range, sends it, and waits for the next control cycle. While the camera
  // is lost (ControlCycle::kLostCamera), the call does not return, and the head holds the target.
  Result<void> step(const host::Gaze& target);

  Time now() const { return input_.now; }
  host::Gaze measured() const { return host::gaze_of(input_.posture.angle); }
  const host::JointAngles& posture() const { return input_.posture.angle; }
  BallTracker& tracker() { return tracker_; }
  // Length of the present series of images in which the ball was detected. An image without a ball ends the
  // series.
  int consecutive() const { return consecutive_; }
  // Exposure of the newest image processed; zero before the first image.
  Time newest_exposure() const { return newest_exposure_; }
  // All images processed since begin().
  const std::vector<PictureRow>& pictures() const { return pictures_; }
  // The newest observation with a ball.
  const std::optional<vision::BallObservation>& ball() const { return ball_; }

 private:
  HeadControl(Context& context, std::string_view behavior);
  Result<void> step_once(const host::Gaze& target);
  bool camera_lost() const {
    return newest_exposure_ > Time{} && now() - newest_exposure_ > ControlCycle::kLostCamera;
  }
  void process(const std::vector<vision::BallObservation>& observations);

  Context* context_;
  std::string_view behavior_;
  ControlCycle cycle_;
  ControlCycle::Input input_;
  BallTracker tracker_;
  int consecutive_ = 0;
  Time newest_exposure_{};
  std::vector<PictureRow> pictures_;
  std::optional<vision::BallObservation> ball_;
};

}  // namespace kaz::behavior
