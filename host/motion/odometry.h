// Where the robot is, from the feet that carry it and the heading.
// SPDX-License-Identifier: Apache-2.0
//
// The sole that carries is taken to stand still and flat on the floor: what the potentiometers say of
// its leg angles then determine where the trunk's origin (midway between the hips) is. While both carry, each
// counts by its share of the weight: soles that slip against each other slip about as much to both
// sides. The frame is that of the start: x ahead, y left, origin below the hips' middle. Metres, rad.
#pragma once

#include <Eigen/Core>

#include "host/motion/body_model.h"

namespace kaz::motion {

struct Place {
  double x = 0, y = 0, heading = 0;
  // One sigma. Along the path: 1.5 % of its length (slip and gear play; docs/explanation/motion.md); across
  // it also the effect of the heading's error.
  double sigma_along = 0, sigma_across = 0, sigma_heading = 0;
};

class Odometry {
 public:
  // `left_share`: of the weight, 0 to 1. Postures in order.
  void add(const JointAngles& measured, double left_share, double heading, double sigma_heading);
  const Place& place() const { return place_; }
  double walked() const { return walked_; }  // m, ahead positive
  double way() const { return way_; }        // m, path length: steps ahead and back both add

 private:
  Place place_;
  double walked_ = 0, way_ = 0;
  bool started_ = false;
  std::array<Eigen::Vector2d, 2> hips_{};  // seen from each sole
};

// The trunk's origin over a sole that is flat on the floor, in the sole's axes.
Eigen::Vector3d hips_over_sole(const JointAngles& measured, Side side);

}  // namespace kaz::motion
