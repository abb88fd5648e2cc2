// Where the head must look to have the ball in the middle of the left eye, now and a little later.
// SPDX-License-Identifier: Apache-2.0
//
// Each observation is turned into the head angles that would have centred the ball at its exposure:
// its place in the trunk's frame follows from the head's angles at the exposure, which are part of
// the frame information, so that a still ball gives the same angles however late the result comes
// and however the head moves meanwhile. A filter for each angle gives speed and the way on. The
// trunk is taken to stand still.
#pragma once

#include "host/behavior/angle_filter.h"
#include "host/robot/kinematics.h"
#include "vision/ball.h"

namespace kaz::behavior {

class BallTracker {
 public:
  // The way on is believed for this long after the last observation; then the ball is taken to
  // rest.
  static constexpr Time kBelieved = std::chrono::milliseconds(200);

  BallTracker();

  // True if it was used: a ball was found, and the posture at its exposure is known.
  bool observe(const vision::BallObservation& observation);
  void forget();

  bool known() const { return pan_.known(); }
  Time last_seen() const { return pan_.latest(); }  // exposure of the last observation used
  // Head angles that centre the ball at time t, as far as is known. known() must hold.
  host::Gaze at(Time t) const;

 private:
  AngleFilter pan_, tilt_;
};

}  // namespace kaz::behavior
