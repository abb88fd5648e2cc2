// Odometry: place of the robot from its supporting feet and the heading.
// SPDX-License-Identifier: Apache-2.0
//
// The supporting sole is assumed to stand still and flat on the floor. The measured leg angles then
// determine the position of the trunk's origin (midway between the hips). While both feet support, each
// counts by its share of the weight, because soles that slip against each other slip about equally to both
// sides. Frame: the robot's frame at the start; x ahead, y left, origin below the middle of the hips. Units:
// m, rad.
#pragma once

#include <Eigen/Core>

#include "host/motion/body_model.h"

namespace kaz::motion {

struct Place {
  double x = 0, y = 0, heading = 0;
  // One sigma. Along the path: 1.5 % of its length (slip and gear play; docs/explanation/motion.md). Across
  // it, the effect of the heading's error is added.
  double sigma_along = 0, sigma_across = 0, sigma_heading = 0;
};

class Odometry {
 public:
  // Adds a posture, in order of time. `left_share`: share of the weight on the left foot, 0 to 1.
  void add(const JointAngles& measured, double left_share, double heading, double sigma_heading);
  const Place& place() const { return place_; }
  double walked() const { return walked_; }  // m, ahead positive
  double way() const { return way_; }        // m, path length; steps ahead and back both add

 private:
  Place place_;
  double walked_ = 0, way_ = 0;
  bool started_ = false;
  std::array<Eigen::Vector2d, 2> hips_{};  // position of the hips from each sole
};

// Returns the position of the trunk's origin over a sole that is flat on the floor, in the sole's axes.
Eigen::Vector3d hips_over_sole(const JointAngles& measured, Side side);

}  // namespace kaz::motion
