// get-up: from wherever it fell to the walking crouch, by how the accelerometer says that it lies.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/behavior.h"

namespace kaz::behavior {

// How a robot lies, by its accelerometer: which way is up, seen from the trunk.
enum class Lies { on_face, on_back, on_left, on_right, upright };
// Specific force in g, ahead and to the left, as it is at rest.
Lies lies_by(double forward_g, double left_g);

extern const Behavior kGetUp;

}  // namespace kaz::behavior
