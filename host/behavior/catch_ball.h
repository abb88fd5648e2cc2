// Search, approach, pick up and hold, for behaviours that end with it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/body_control.h"

namespace kaz::behavior {

struct CatchOptions {
  int tries = 4;
  int turns = 3;      // quarter turns of the body in the search
  double hold_s = 3;  // for which the ball is held
  bool left_first = false;
};

// A ball in view is approached at once, else it is searched for. Precondition: the robot stands in the
// crouch (BodyControl::begin).
Result<Outcome> catch_ball(BodyControl& body, const CatchOptions& options);

}  // namespace kaz::behavior
