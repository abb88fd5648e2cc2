// Random positions of the ball in the picture, at a given distance and above the floor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/random.hpp"
#include "tests/studies/vision_table/eyes.h"
#include "tests/studies/vision_table/table.h"
#include "vision/color/ball.h"

namespace kaz::vision_table {

struct Placement {
  Eigen::Isometry3d eye = Eigen::Isometry3d::Identity();
  double u = 0, v = 0, distance_m = 0;  // center of the ball: px, and distance from the eye
  Eigen::Vector3d ball = Eigen::Vector3d::Zero();  // in the world
};

// Chooses an eye pose and a ball position, and places ball and board in `world`. The eye is 0.25 to 0.45 m
// above the floor.
Placement place_ball(Random& random, const vision::CameraModel& camera, double distance_m,
                     Visibility visibility, World& world);

// Returns whether an observation matches the ball: closer to its center than 3 px or half its radius,
// whichever is larger.
bool at_the_ball(const Placement& place, const vision::CameraModel& camera,
                 const vision::BallObservation& ball);

}  // namespace kaz::vision_table
