// Odometry: computes the robot's place from the heading and the movement of the hips over the feet.
// SPDX-License-Identifier: Apache-2.0
//
// The supporting sole is assumed to stand still and flat on the floor. The measured leg angles then determine
// the position of the trunk's origin (midway between the hips). While both feet support, the positions from
// both feet are averaged. Each position is weighted by the share of the robot's weight on the foot. If both
// soles slip on the floor in opposite directions, they slip about equally far. So the errors of the two feet
// mostly cancel in the mean. Frame: the robot's frame at the start; x ahead, y left, origin below the
// midpoint of the hips. Units: m, rad.
#pragma once

#include <Eigen/Core>

#include "host/motion/body_model.h"

namespace kaz::motion {

struct Place {
  double x = 0, y = 0, heading = 0;
  // The standard deviation along the path is 1.5 % of the path's length (slip and gear play;
  // docs/explanation/motion.md). The standard deviation across the path also includes the effect of the
  // heading's error.
  double sigma_along = 0, sigma_across = 0, sigma_heading = 0;
};

class Odometry {
 public:
  // Adds a posture, in order of time. `left_share`: share of the weight on the left foot, 0 to 1.
  void add(const JointAngles& measured, double left_share, double heading, double sigma_heading);
  const Place& place() const { return place_; }
  double walked() const { return walked_; }  // m, distance walked; positive ahead
  // Path length, m; forward and backward steps both increase the length.
  double way() const { return way_; }

 private:
  Place place_;
  double walked_ = 0, way_ = 0;
  bool started_ = false;
  std::array<Eigen::Vector2d, 2> hips_{};  // position of the hips relative to each sole
};

// Returns the position of the trunk's origin over a sole that is flat on the floor, in the sole's axes.
Eigen::Vector3d hips_over_sole(const JointAngles& measured, Side side);

}  // namespace kaz::motion
