// Whole-body control for behaviors: legs, arms, head and ball tracking in one exchange per control cycle.
// SPDX-License-Identifier: Apache-2.0
//
// In each cycle, either the legs follow motion::Motion, or all joints except those of the neck follow a pose.
// The head holds a gaze or tracks the ball. Each cycle reads posture, inertial data and ball observations.
// Sending 18 targets and receiving the reply takes 14 ms at 115,200 baud, so cycles last 10 to 20 ms.
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
  // Enables the motors, moves into the crouch and zeroes the gyro (Walker::begin). Returns the errors of
  // Walker::begin. Also fails (usage) without a camera. The context must outlive the returned object.
  static Result<BodyControl> begin(Context& context, std::string_view behavior);

  // Sets a fixed gaze, from the next cycle on.
  void set_gaze(const host::Gaze& gaze) { gaze_ = gaze, tracks_ball_ = false; }
  // Tracks the ball, from the next cycle on. While the ball's position is unknown, the head holds the last
  // gaze.
  void track_ball() { tracks_ball_ = true; }

  // Runs one control cycle with the leg targets of Motion. If the robot falls, the motors are disabled and
  // fallen() returns true. While the camera is lost (ControlCycle::kLostCamera), the call stops Motion, keeps
  // the robot standing, and does not return.
  Result<void> step();
  // Runs one control cycle with the angles of `pose` for all joints except those of the neck. Motion is
  // suspended in this cycle. A sequence of poses must start and end at home(). Call restart() before the next
  // step() without a pose.
  Result<void> step(const host::JointAngles& pose);
  // Runs step() for `duration`, or until the robot falls.
  Result<void> stay(Time duration);
  // Runs step() until Motion is idle, then stands still for the time `after`.
  Result<void> finish(Time after = std::chrono::milliseconds(300));
  // Resets odometry, heading and ball track after a sequence of poses. Then keeps the robot standing for
  // 2.6 s. During this time, the gyro is zeroed.
  Result<void> restart();

  motion::Motion& motion() { return motion_; }
  bool fallen() const { return fallen_ || motion_.state() == motion::State::fallen; }
  Time now() const { return input_.now; }
  const host::JointAngles& measured() const { return input_.posture.angle; }
  Context& context() { return *context_; }
  void phase(std::string_view phase) { context_->sink.phase(now(), behavior_, phase); }

  // ---- Observations
  const std::vector<vision::BallObservation>& observations() const {  // from the latest cycle
    return input_.observations;
  }
  Time newest_exposure() const { return newest_exposure_; }
  // True if no image came for 0.4 s.
  bool blind() const { return now() - newest_exposure_ > kFrozen; }
  // Counts the images in which ball() accepted an observation. Each image without an accepted observation
  // resets the count to 0.
  int consecutive() const { return consecutive_; }
  BallPlace& ball() { return ball_; }
  // The newest observation that ball() used.
  const std::optional<vision::BallObservation>& newest_ball() const { return newest_ball_; }
  // Odometry of the last 2 to 4 s; restart() clears it.
  const PlaceHistory& places() const { return places_; }
  // Position of the ball, m; x ahead, y left, origin below the hips. Precondition: ball().known().
  Eigen::Vector2d ball_now() const { return ball_.from_hips(now(), motion_.place()); }
  // Returns true if the time from the newest observation of the ball to the newest image is above `time`.
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
  // The function step(pose) uses `left_g_` and `tipped_s_` to detect a fall. `left_g_`: filtered lateral
  // acceleration, in units of gravity. `tipped_s_`: duration of the present strong tilt, s; 0 if the tilt is
  // not strong.
  double left_g_ = 0, tipped_s_ = 0;
};

}  // namespace kaz::behavior
