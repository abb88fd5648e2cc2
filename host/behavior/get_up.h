// Classifies how a fallen robot lies, from its accelerometer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::behavior {

// Side of the trunk that is down.
enum class Lying { on_face, on_back, on_left, on_right, upright };
// Returns the side of the trunk that is down. Precondition: the trunk is at rest. The arguments are the
// specific force in g, along the trunk's x axis (forward) and y axis (left).
Lying lying_from(double forward_g, double left_g);

}  // namespace kaz::behavior
