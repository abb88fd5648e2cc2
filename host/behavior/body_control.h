// The whole body as behaviours move it: legs, arms and head in one exchange a beat, and the ball.
// SPDX-License-Identifier: Apache-2.0
//
// Legs come from motion::Motion, or all but the head from a pose; the head looks where it was told or
// follows the ball. Each beat takes in posture, inertial codes and what was seen. 18 targets and their
// answer are 14 ms of a line of 115,200 baud, so beats last 10 to 20 ms.
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
  // Motors on, into the crouch, the gyro zeroed: Walker::begin(). Fails as that does and (usage)
  // without eyes.
  static Result<BodyControl> begin(Context& context, std::string_view behavior);

  // Where the head looks from the next beat on: at angles, or after the ball (while it is not known,
  // where it looked last).
  void look(const host::Gaze& gaze) { gaze_ = gaze, follows_ = false; }
  void look_at_ball() { follows_ = true; }

  // One beat: legs as Motion has them. A fall switches the motors off, and fallen() says so.
  Result<void> step();
  // One beat with these angles for all joints but the neck's; Motion rests meanwhile. It must go on
  // from home() and come back there before step() is called again, after restart().
  Result<void> step(const host::JointAngles& pose);
  Result<void> stay(Time duration);
  // Beats until Motion has nothing left to do, then `after` of standing.
  Result<void> finish(Time after = std::chrono::milliseconds(300));
  // Odometry, heading and ball begin anew: after a pose. Stands until the gyro is zeroed.
  Result<void> restart();

  motion::Motion& motion() { return motion_; }
  bool fallen() const { return fallen_ || motion_.state() == motion::State::fallen; }
  Time now() const { return input_.now; }
  const host::JointAngles& measured() const { return input_.posture.angle; }
  Context& context() { return *context_; }
  void phase(std::string_view phase) { context_->sink.phase(now(), behavior_, phase); }

  // ---- What is seen
  const std::vector<vision::BallObservation>& seen() const { return input_.seen; }  // this beat
  Time newest_exposure() const { return newest_exposure_; }
  // No picture for 0.4 s: the camera stands still.
  bool blind() const { return now() - newest_exposure_ > kFrozen; }
  int seen_in_a_row() const { return seen_in_a_row_; }
  BallPlace& ball() { return ball_; }
  // From below the hips; ball().known() must hold.
  Eigen::Vector2d ball_now() const { return ball_.from_hips(now(), motion_.place()); }
  // Pictures came, and none of the last `time` showed it.
  bool unseen_for(Time time) const { return newest_exposure_ - ball_.last_seen() > time; }

 private:
  static constexpr Time kFrozen = std::chrono::milliseconds(400);
  BodyControl(Context& context, std::string_view behavior, const motion::Motion& motion);
  host::Gaze head();
  Result<void> beat(std::vector<host::JointTarget> targets);
  void take_in();
  void watch_for_a_fall();

  Context* context_;
  std::string_view behavior_;
  motion::Motion motion_;
  ControlCycle cycle_;
  ControlCycle::Input input_;
  BallPlace ball_;
  host::Gaze gaze_{0, 0.5};
  bool follows_ = false, fallen_ = false;
  int seen_in_a_row_ = 0;
  Time newest_exposure_{};
  Time beat_ = ControlCycle::kPeriod;
  double left_g_ = 0, tipped_s_ = 0;  // while a pose is held
};

}  // namespace kaz::behavior
