// approach-ball: walk until the ball lies where a hand can take it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/body_control.h"

namespace kaz::behavior {

extern const Behavior kApproachBall;

// Looks around with the head and, where a whole scan showed nothing, with the body turned by a
// quarter, up to `turns` times. True when the ball was seen on the floor in three pictures in a row.
Result<bool> look_around(BodyControl& body, int turns, bool left_first);

struct Approached {
  host::Side hand = host::Side::right;  // the nearer one
  Eigen::Vector2d ball{0, 0};           // m, from the middle of the ankles
  std::string cause = {};               // why it is not there: "lost", "not reached", "fell"
};
// The ball must be known. Turns and walks, vision all the way, and ends standing.
Result<Approached> approach(BodyControl& body);

// Whether a ball that lies there can be picked up with some room for error, and the hand for it.
std::optional<host::Side> hand_for(const Eigen::Vector2d& ball);

}  // namespace kaz::behavior
