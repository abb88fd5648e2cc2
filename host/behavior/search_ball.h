// Searches for a ball by moving the head, as in section 4.2 of the paper (README.md).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/head_control.h"

namespace kaz::behavior {

// Resets the tracker and moves the head along the search pattern. Returns true once the ball was detected
// in three consecutive images, or false after `limit`.
Result<bool> search(HeadControl& head, Time limit, bool left_first);

}  // namespace kaz::behavior
