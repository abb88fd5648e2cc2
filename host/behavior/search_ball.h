// search-ball: look around to find a ball (paper, section 4.2).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/head_control.h"

namespace kaz::behavior {

extern const Behavior kSearchBall;

// Moves the head along the search pattern until the ball was in so many pictures in a row that it
// is no mistake, or `limit` has passed. True if it was found. What the tracker knew before is
// forgotten.
Result<bool> search(HeadControl& head, Time limit, bool left_first);

}  // namespace kaz::behavior
