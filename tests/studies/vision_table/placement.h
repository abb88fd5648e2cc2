// Places for the ball: somewhere in the picture, at a distance, above the floor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/random.hpp"
#include "tests/studies/vision_table/eyes.h"
#include "tests/studies/vision_table/table.h"
#include "vision/color/ball.h"

namespace kaz::vision_table {

struct Placement {
  Eigen::Isometry3d eye = Eigen::Isometry3d::Identity();
  double u = 0, v = 0, distance_m = 0;             // of the ball's centre
  Eigen::Vector3d ball = Eigen::Vector3d::Zero();  // in the world
};

// Also puts ball and board there. The eye is 0.3 m above the floor.
Placement place_ball(Random& random, const vision::CameraModel& camera, double distance_m,
                     Visibility visibility, World& world);

// Whether an observation is of the ball: within 3 px of it, or within half its radius.
bool at_the_ball(const Placement& place, const vision::CameraModel& camera,
                 const vision::BallObservation& ball);

}  // namespace kaz::vision_table
