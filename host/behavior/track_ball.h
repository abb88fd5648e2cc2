// track-ball: track a ball by controlling the head (paper, section 4.2).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/behavior.h"

namespace kaz::behavior {

extern const Behavior kTrackBall;

}  // namespace kaz::behavior
