// turn-left and turn-right: on the spot, by an angle.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/behavior.h"

namespace kaz::behavior {

extern const Behavior kTurnLeft, kTurnRight;

}  // namespace kaz::behavior
