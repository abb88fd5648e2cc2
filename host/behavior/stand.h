// stand: motors on, and slowly into a posture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/behavior.h"

namespace kaz::behavior {

extern const Behavior kStand;

}  // namespace kaz::behavior
