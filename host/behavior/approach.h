// Finds a ball and walks until a hand can reach it. Shared by the behaviors that approach or catch a ball.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/body_control.h"

namespace kaz::behavior {

// Resets the ball track and scans with the head. After each complete scan without a ball, turns the body by
// 90 degrees, up to `turns` times. Returns true as soon as the ball has been detected on the floor in
// three consecutive images.
Result<bool> scan_for_ball(BodyControl& body, int turns, bool left_first);

struct Approached {
  host::Side hand = host::Side::right;  // valid if `cause` is empty
  Eigen::Vector2d ball{0, 0};           // m; x ahead, y left, from the midpoint of the ankles
  std::string cause = {};  // empty on success, else the reason: "lost", "not reached", "fell"
};
// Turns and walks toward the ball under visual control. At the end, the robot stands. Precondition:
// body.ball().known().
Result<Approached> approach(BodyControl& body);

// Returns the hand that can pick up the ball. `ball` has the axes and the origin of Approached::ball. The
// hand can pick up the ball even if the position `ball` is wrong by up to 10 mm. Returns nothing if neither
// hand can reach the ball.
std::optional<host::Side> hand_for(const Eigen::Vector2d& ball);

}  // namespace kaz::behavior
