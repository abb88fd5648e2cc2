// Where the head must look to have the ball in the middle of the left eye, now and a little later.
// SPDX-License-Identifier: Apache-2.0
//
// Each observation is placed in the trunk's frame by the head's angles at its exposure, which are
// part of the frame information, so that a still ball stays where it is however late the result
// comes and however the head moves meanwhile. vision::BallTrack gives speed and the way on. The
// trunk is taken to stand still; nothing is known of the floor, so the ball goes straight on.
#pragma once

#include "host/robot/kinematics.h"
#include "vision/color/ball_track.h"

namespace kaz::behavior {

class BallTracker {
 public:
  // The way on is believed for this long after the last observation; then the ball is taken to
  // rest.
  static constexpr Time kBelieved = std::chrono::milliseconds(200);

  // True if it was used: a ball was found where this one may be, and the posture at its exposure is
  // known.
  bool observe(const vision::BallObservation& observation);
  void forget() { track_.forget(); }

  bool known() const { return track_.known(); }
  // Exposure of the newest observation used; zero before the first.
  Time last_seen() const { return known() ? track_.latest() : Time{}; }
  // Head angles that centre the ball at time t, as far as is known. known() must hold.
  host::Gaze at(Time t) const;

 private:
  vision::BallTrack track_;
};

}  // namespace kaz::behavior
