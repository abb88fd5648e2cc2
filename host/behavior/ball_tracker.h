// Head angles that centre the ball in the left camera, now and predicted.
// SPDX-License-Identifier: Apache-2.0
//
// Each observation is transformed to the trunk's frame with the head's angles at its exposure (part of
// the frame information), so that latency and head motion cancel out for a resting ball.
// vision::BallTrack estimates velocity and predicts. Assumes that the trunk is at rest; the floor is
// unknown, so the prediction is a straight line.
#pragma once

#include "host/robot/kinematics.h"
#include "vision/color/ball_track.h"

namespace kaz::behavior {

class BallTracker {
 public:
  // The prediction moves on for this long after the last observation; then the ball is assumed to rest.
  static constexpr Time kMaxPrediction = std::chrono::milliseconds(200);

  // True if the observation was used: the posture at its exposure is known, and it passes the track's
  // gate.
  bool observe(const vision::BallObservation& observation);
  void forget() { track_.forget(); }

  bool known() const { return track_.known(); }
  // Exposure of the newest observation used; zero before the first.
  Time last_seen() const { return known() ? track_.latest() : Time{}; }
  // Predicted head angles that centre the ball at time t. Precondition: known().
  host::Gaze at(Time t) const;

 private:
  vision::BallTrack track_;
};

}  // namespace kaz::behavior
