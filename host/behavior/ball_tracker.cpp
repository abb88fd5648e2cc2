// From observations in the image to head angles that follow them.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/ball_tracker.h"

#include <algorithm>

namespace kaz::behavior {

bool BallTracker::observe(const vision::BallObservation& observation) {
  const vision::FrameInfo& info = observation.info;
  if (!observation.found || !info.posture_known || info.joint_rad.size() != KZ_JOINTS) return false;
  host::JointAngles angle;
  std::copy(info.joint_rad.begin(), info.joint_rad.end(), angle.begin());
  const auto taken = track_.observe(observation, host::trunk_from_eye(angle));
  return taken != vision::BallTrack::Taken::outlier && taken != vision::BallTrack::Taken::refused;
}

host::Gaze BallTracker::at(Time t) const {
  return host::gaze_at(track_.aim(std::min(t, last_seen() + kMaxPrediction)));
}

}  // namespace kaz::behavior
