// Searches for a ball, approaches it, picks it up and holds it. Used by behaviors that end with a catch.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/body_control.h"

namespace kaz::behavior {

struct CatchOptions {
  int tries = 4;
  int turns = 3;      // maximum number of quarter turns of the body during the search
  double hold_s = 3;  // time for which the robot must hold the ball
  // Direction in which the body turns during the search; true: left, false: right. If the head looks straight
  // ahead (pan angle 0) when a search begins, `left_first` also selects the side on which the head begins.
  bool left_first = false;
};

// If a ball is in view, approaches it at once. Otherwise searches for a ball first. Precondition: the robot
// stands in the crouch (BodyControl::begin).
Result<Outcome> catch_ball(BodyControl& body, const CatchOptions& options);

}  // namespace kaz::behavior
