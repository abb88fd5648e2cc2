// Whole-body control for behaviours: legs, arms and head in one exchange per control cycle; ball tracking.
// SPDX-License-Identifier: Apache-2.0
//
// The legs follow motion::Motion, or all joints but the neck's follow a pose; the head holds a gaze or
// tracks the ball. Each cycle reads posture, inertial data and ball observations. 18 targets and their
// reply take 14 ms at 115,200 baud, so cycles last 10 to 20 ms.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "host/behavior/ball_place.h"
#include "host/behavior/control_cycle.h"
#include "host/motion/motion.h"

namespace kaz::behavior {

class BodyControl {
 public:
  // Enables the motors, moves into the crouch and zeroes the gyro (Walker::begin). Fails like it, and
  // (usage) without a camera.
  static Result<BodyControl> begin(Context& context, std::string_view behavior);

  // Gaze from the next cycle on: fixed, or tracking the ball (while its position is unknown, the last
  // gaze is held).
  void set_gaze(const host::Gaze& gaze) { gaze_ = gaze, tracks_ball_ = false; }
  void track_ball() { tracks_ball_ = true; }

  // Runs one control cycle with the leg targets of Motion. If the robot falls, the motors are disabled
  // and fallen() returns true. While the camera is lost (ControlCycle::kLostCamera) it does not return:
  // Motion is stopped, and the robot stands.
  Result<void> step();
  // Runs one control cycle with these angles for all joints but the neck's; Motion is suspended. Poses
  // must start at home() and return to it; then call restart() before the next step().
  Result<void> step(const host::JointAngles& pose);
  Result<void> stay(Time duration);
  // Steps until Motion is idle, then stands for `after`.
  Result<void> finish(Time after = std::chrono::milliseconds(300));
  // Resets odometry, heading and ball track, after a sequence of poses. Stands until the gyro is zeroed.
  Result<void> restart();

  motion::Motion& motion() { return motion_; }
  bool fallen() const { return fallen_ || motion_.state() == motion::State::fallen; }
  Time now() const { return input_.now; }
  const host::JointAngles& measured() const { return input_.posture.angle; }
  Context& context() { return *context_; }
  void phase(std::string_view phase) { context_->sink.phase(now(), behavior_, phase); }

  // ---- Observations
  const std::vector<vision::BallObservation>& observations() const {  // of this cycle
    return input_.observations;
  }
  Time newest_exposure() const { return newest_exposure_; }
  // No image for 0.4 s.
  bool blind() const { return now() - newest_exposure_ > kFrozen; }
  // Number of consecutive images in which the ball was detected.
  int consecutive() const { return consecutive_; }
  BallPlace& ball() { return ball_; }
  // The newest observation that was used for it.
  const std::optional<vision::BallObservation>& newest_ball() const { return newest_ball_; }
  // Odometry of the last seconds; anew after restart().
  const PlaceHistory& places() const { return places_; }
  // m; x ahead, y left, from the point below the hips. Precondition: ball().known().
  Eigen::Vector2d ball_now() const { return ball_.from_hips(now(), motion_.place()); }
  // Images came, but no detection in those of the last `time`.
  bool unseen_for(Time time) const { return newest_exposure_ - ball_.last_seen() > time; }

 private:
  static constexpr Time kFrozen = std::chrono::milliseconds(400);
  BodyControl(Context& context, std::string_view behavior, const motion::Motion& motion);
  host::Gaze head();
  Result<void> step_once();
  bool camera_lost() const { return now() - newest_exposure_ > ControlCycle::kLostCamera; }
  Result<void> run_cycle(std::vector<host::JointTarget> targets);
  void process_observations();
  void detect_fall();

  Context* context_;
  std::string_view behavior_;
  motion::Motion motion_;
  ControlCycle cycle_;
  ControlCycle::Input input_;
  PlaceHistory places_;
  BallPlace ball_;
  std::optional<vision::BallObservation> newest_ball_;
  host::Gaze gaze_{0, 0.5};
  bool tracks_ball_ = false, fallen_ = false;
  int consecutive_ = 0;
  Time newest_exposure_{};
  Time cycle_time_ = ControlCycle::kPeriod;  // duration of the last cycle
  double left_g_ = 0, tipped_s_ = 0;         // fall detection during poses
};

}  // namespace kaz::behavior
