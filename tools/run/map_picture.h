// Draws the map of a behavior, and converts the map for the recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/sink.h"
#include "sim/runtime/simulation/recorded_map.h"
#include "tools/drawing/figure.h"

namespace kaz::tools {

// Draws all known cells with a margin of 15 cm. Floor is green, obstacles red, unknown cells gray. The trail
// is blue, the path white, the goal a yellow crosshair, the robot a black arrow. Grid lines are 0.5 m apart.
// The map's x axis (forward) points up in the picture, and its y axis (left) points to the left.
figure::Image map_picture(const behavior::MapReport& report);

sim::RecordedMap recorded_map(const behavior::MapReport& report);

}  // namespace kaz::tools
