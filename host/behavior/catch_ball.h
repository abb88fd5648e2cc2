// Search, approach, pick up and hold a ball, for behaviors that end with it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/body_control.h"

namespace kaz::behavior {

struct CatchOptions {
  int tries = 4;
  int turns = 3;      // quarter turns of the body during the search
  double hold_s = 3;  // required holding time
  // Body turns go to the left; so does the first head sweep if both ends are equally near.
  bool left_first = false;
};

// Approaches a ball in view at once, otherwise searches for one first. Precondition: the robot stands in
// the crouch (BodyControl::begin).
Result<Outcome> catch_ball(BodyControl& body, const CatchOptions& options);

}  // namespace kaz::behavior
