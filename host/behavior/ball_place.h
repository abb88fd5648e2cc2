// Where a ball lies on the floor, from one eye, while the robot walks.
// SPDX-License-Identifier: Apache-2.0
//
// The ball's centre is its radius above the floor, so the ray from the eye that sees it ends there: far
// sharper than the distance that its size tells, which only decides whether it can be that ball on the
// floor at all. Where the eye is over the floor follows from the leg that carries, whose sole is flat
// (host/robot/kinematics.h); the body's sway in walking is in that leg's angles.
// Metres, radians.
#pragma once

#include <deque>
#include <optional>

#include "host/motion/odometry.h"
#include "vision/color/ball_track.h"

namespace kaz::behavior {

// On the floor, x ahead and y left.
struct FloorPoint {
  Eigen::Vector2d from_middle{0, 0};  // of the ankles, where both feet stand side by side
  Eigen::Vector2d from_hips{0, 0};    // of the place below the trunk's origin
  Eigen::Vector2d along{1, 0};        // the way the eye looks, over the floor
  double sigma_along = 0, sigma_across = 0;
};
// Nothing where there is no ball, its posture is unknown, the eye looks at it less than 8 degrees
// downward, or its size says that it is elsewhere: lifted, in a hand, or no such ball.
std::optional<FloorPoint> on_floor(const vision::BallObservation& seen, double radius);

// Angles of the head that point the left eye at a place over the floor, seen from the middle of the
// ankles.
host::Gaze gaze_at_floor(const host::JointAngles& angles, const Eigen::Vector3d& from_middle);

// The ball in the frame of odometry, which stands still while the robot walks.
class BallPlace {
 public:
  explicit BallPlace(double radius);

  // Where the robot was at the time of a posture, in order.
  void at_place(Time t, const motion::Place& place);
  // True if it was used. The place at its exposure must be among those that were told.
  bool observe(const vision::BallObservation& seen);
  void forget() { track_.forget(); }
  // Forgets the places, too: odometry begins anew.
  void restart();

  bool known() const { return track_.known(); }
  Time last_seen() const { return known() ? track_.latest() : Time{}; }
  // At that time, in the robot's frame below the hips; known() must hold. Believed to roll on for
  // 0.3 s after it was seen last.
  Eigen::Vector2d from_hips(Time t, const motion::Place& robot) const;
  double speed() const;  // m/s over the floor

 private:
  std::optional<motion::Place> place_at(Time t) const;

  double radius_;
  vision::BallTrack track_;
  std::deque<std::pair<Time, motion::Place>> places_;
};

}  // namespace kaz::behavior
