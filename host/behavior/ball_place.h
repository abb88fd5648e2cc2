// Position of a ball on the floor, from one camera, while the robot walks.
// SPDX-License-Identifier: Apache-2.0
//
// The ball's center is one ball radius above the floor. So the center is the intersection of two objects: the
// viewing ray through the center, and the plane at this height. The intersection is far more accurate than a
// position computed from the ball's apparent size. The apparent size is used only for a plausibility check.
// The sole of the supporting leg is flat on the floor. So the camera pose over the floor is computed from the
// joint angles of this leg (host/robot/kinematics.h). This pose includes the sway of walking. Units: m, rad.
#pragma once

#include <optional>

#include "host/behavior/place_history.h"
#include "host/motion/odometry.h"
#include "vision/color/ball_track.h"

namespace kaz::behavior {

// A point on the floor. Axes: x ahead, y left.
struct FloorPoint {
  // Origin: point midway between the ankles when the feet are side by side.
  Eigen::Vector2d from_middle{0, 0};
  // Origin: on the floor, below the trunk's origin.
  Eigen::Vector2d from_hips{0, 0};
  Eigen::Vector2d along{1, 0};               // unit vector of the ray's projection on the floor
  double sigma_along = 0, sigma_across = 0;  // standard deviations along and across the ray
};
// Computes the position of the observed ball. `radius`: radius of the ball, m. Returns nothing if there is no
// detection, if the posture at the exposure is unknown, or if the ray descends by less than 8 degrees. Also
// returns nothing if the ball's apparent size contradicts the computed position, for example because the ball
// is in a hand.
std::optional<FloorPoint> on_floor(const vision::BallObservation& seen, double radius);

// Returns the head angles that point the left camera at `from_middle`, a point in m relative to the midpoint
// of the ankles.
host::Gaze gaze_at_floor(const host::JointAngles& angles, const Eigen::Vector3d& from_middle);

// Tracks the ball in the odometry frame, which is fixed to the floor.
class BallPlace {
 public:
  explicit BallPlace(double radius);

  // Returns true if the observation was used. `places` must contain the odometry at the exposure of `seen`.
  bool observe(const vision::BallObservation& seen, const PlaceHistory& places);
  void forget() { track_.forget(); }

  bool known() const { return track_.known(); }
  Time last_seen() const { return known() ? track_.latest() : Time{}; }
  // Predicts the position of the ball at the time `t`, and returns this position relative to the robot. The
  // origin is below the hips. `robot`: place of the robot in the odometry frame. The ball is assumed to roll
  // for 0.3 s after the newest observation, and then to rest. Precondition: known().
  Eigen::Vector2d from_hips(Time t, const motion::Place& robot) const;
  // Returns the predicted position of the ball in the odometry frame. Precondition: known().
  Eigen::Vector2d at(Time t) const;
  double speed() const;  // m/s over the floor; 0 while the ball is unknown

 private:
  double radius_;
  vision::BallTrack track_;
};

}  // namespace kaz::behavior
