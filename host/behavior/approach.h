// Finds a ball and walks until a hand can reach it: parts of approach-ball and catch-ball.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/body_control.h"

namespace kaz::behavior {

// Scans with the head and, after each complete scan without a ball, turns the body by 90 degrees, up to
// `turns` times. True when the ball was detected on the floor in three consecutive images.
Result<bool> scan_for_ball(BodyControl& body, int turns, bool left_first);

struct Approached {
  host::Side hand = host::Side::right;  // the nearer one
  Eigen::Vector2d ball{0, 0};           // m; x ahead, y left, from the midpoint of the ankles
  std::string cause = {};               // of failure: "lost", "not reached", "fell"; empty: success
};
// Turns and walks under visual control and ends standing. Precondition: body.ball().known().
Result<Approached> approach(BodyControl& body);

// The hand that can pick up a ball at this position with some tolerance; nothing if neither can.
std::optional<host::Side> hand_for(const Eigen::Vector2d& ball);

}  // namespace kaz::behavior
