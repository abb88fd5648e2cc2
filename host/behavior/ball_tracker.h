// Predicts the head angles that center the ball in the left camera.
// SPDX-License-Identifier: Apache-2.0
//
// Each observation is transformed to the trunk frame with the head angles at the exposure, which are part of
// the frame information. So latency and head motion cause no error for a resting ball. vision::BallTrack
// estimates the ball's velocity and predicts the ball's position. The trunk is assumed to be at rest. The
// position of the floor is unknown, so the predicted motion is a straight line.
#pragma once

#include "host/robot/kinematics.h"
#include "vision/color/ball_track.h"

namespace kaz::behavior {

class BallTracker {
 public:
  // Longest extrapolation after the last observation. After this time, the ball is assumed to rest.
  static constexpr Time kMaxPrediction = std::chrono::milliseconds(200);

  // Returns true if the observation was used, which requires that the posture at the exposure is known and
  // that the track's gate accepts the observation.
  bool observe(const vision::BallObservation& observation);
  void forget() { track_.forget(); }

  bool known() const { return track_.known(); }
  // Exposure of the newest observation used; zero before the first observation.
  Time last_seen() const { return known() ? track_.latest() : Time{}; }
  // Returns the predicted head angles that center the ball at time `t`. Precondition: known().
  host::Gaze at(Time t) const;

 private:
  vision::BallTrack track_;
};

}  // namespace kaz::behavior
