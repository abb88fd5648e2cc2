// Classifies how a fallen robot lies, from its accelerometer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::behavior {

// Side of the trunk that is down.
enum class Lying { on_face, on_back, on_left, on_right, upright };
// Returns the side that is down, from the specific force at rest along the trunk's x axis (forward) and y
// axis (left), in g.
Lying lying_from(double forward_g, double left_g);

}  // namespace kaz::behavior
