// Predicts the head angles that center the ball in the left camera.
// SPDX-License-Identifier: Apache-2.0
//
// Each observation contains the head angles at the exposure of the image. With these angles, the observation
// is transformed to the coordinates of the trunk. So latency and head motion cause no error for a resting
// ball. vision::BallTrack estimates the ball's velocity and predicts the ball's position. The trunk is
// assumed to be at rest. The position of the floor is unknown, so the predicted motion is a straight line.
#pragma once

#include "host/robot/kinematics.h"
#include "vision/color/ball_track.h"

namespace kaz::behavior {

class BallTracker {
 public:
  // The ball's motion is predicted for at most kMaxPrediction after the newest observation. Later, the ball
  // is assumed to rest.
  static constexpr Time kMaxPrediction = std::chrono::milliseconds(200);

  // Returns true if the observation was used. Three conditions must be met: the observation contains a ball,
  // the posture at the exposure is known, and the track's gate accepts the observation.
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
