// The head as behaviours move it: one target a cycle, with tracker and log.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/behavior/ball_tracker.h"
#include "host/behavior/control_cycle.h"
#include "host/robot/kinematics.h"

namespace kaz::behavior {

class HeadControl {
 public:
  // How long after a behaviour has decided on a target the head is there, if the target moves
  // steadily: sending, the ramp, and the lag of the position loop. That loop drives with the share
  // kp * error - kd * rate of full duty, and a motor without load runs at duty * w0, w0 = 11.46
  // rad/s at 10 V (design, section 4). So error / rate = (kd + 1/w0) / kp = (0.15 + 1/11.46) / 20 =
  // 12 ms.
  static constexpr Time kServoLag = std::chrono::milliseconds(12);
  static constexpr Time kLead = ControlCycle::kSendDelay + ControlCycle::kRamp + kServoLag;
  // Targets stay this far inside the joints' limits.
  static constexpr double kMargin = 0.017;

  // Motors on where they stand; reads the first state. Fails if there is no sight.
  static Result<HeadControl> begin(Context& context, std::string_view behavior);

  void phase(std::string_view phase) { context_->sink.phase(now(), behavior_, phase); }
  // Sends a target (limited to the joints' range) and waits for the next beat.
  Result<void> step(const host::Gaze& target);

  Time now() const { return input_.now; }
  host::Gaze measured() const { return host::gaze_of(input_.posture.angle); }
  BallTracker& tracker() { return tracker_; }
  // Pictures with a ball since the last one without.
  int seen_in_a_row() const { return seen_in_a_row_; }
  // Exposure of the newest picture that was looked at; zero before the first.
  Time newest_exposure() const { return newest_exposure_; }
  const std::vector<PictureRow>& pictures() const { return pictures_; }
  // The newest observation with a ball.
  const std::optional<vision::BallObservation>& ball() const { return ball_; }

 private:
  HeadControl(Context& context, std::string_view behavior);
  void take_in(const std::vector<vision::BallObservation>& seen);

  Context* context_;
  std::string_view behavior_;
  ControlCycle cycle_;
  ControlCycle::Input input_;
  BallTracker tracker_;
  int seen_in_a_row_ = 0;
  Time newest_exposure_{};
  std::vector<PictureRow> pictures_;
  std::optional<vision::BallObservation> ball_;
};

}  // namespace kaz::behavior
