// From observations in the image to filtered head angles.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/ball_tracker.h"

#include <algorithm>
#include <numbers>

namespace kaz::behavior {

namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Measurement: a third of a pixel (0.1 degree at 190 pixels focal length), the potentiometers (0.19
// degree a code, half a code of noise), and 1 ms of uncertainty in time at 50 degrees/s.
// Acceleration: a ball that may turn round within some 50 ms at 50 degrees/s; a power density of 2
// gives a deviation of sqrt(2 * 0.05) = 0.3 rad/s in that time, half of it unforeseen.
constexpr AngleFilter::Noise kNoise{.measurement_rad = 0.2 * kDegree,
                                    .acceleration_psd = 2,
                                    .initial_rate = 1,
                                    .jump_rad = 15 * kDegree};

}  // namespace

BallTracker::BallTracker() : pan_(kNoise), tilt_(kNoise) {}

bool BallTracker::observe(const vision::BallObservation& observation) {
  const vision::FrameInfo& info = observation.info;
  if (!observation.found || !info.posture_known || info.joint_rad.size() != KZ_JOINTS) return false;
  host::JointAngles angle;
  std::copy(info.joint_rad.begin(), info.joint_rad.end(), angle.begin());
  const host::Gaze gaze = host::gaze_at(host::trunk_from_eye(angle) * observation.position());
  pan_.observe(info.exposure, gaze.pan_rad);
  tilt_.observe(info.exposure, gaze.tilt_rad);
  return true;
}

void BallTracker::forget() {
  pan_.forget();
  tilt_.forget();
}

host::Gaze BallTracker::at(Time t) const {
  const Time until = std::min(t, last_seen() + kBelieved);
  return {pan_.aim(until), tilt_.aim(until)};
}

}  // namespace kaz::behavior
