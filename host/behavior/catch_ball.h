// catch-ball: find a ball on the floor, walk there, pick it up, hold it (paper, section 4.2).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/behavior.h"

namespace kaz::behavior {

extern const Behavior kCatchBall;

}  // namespace kaz::behavior
