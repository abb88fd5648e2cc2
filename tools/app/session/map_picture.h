// The map of a behaviour as a picture, and as the recording takes it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/sink.h"
#include "sim/runtime/simulation/recorded_map.h"
#include "tools/figure/figure.h"

namespace kaz::tools {

// Forward is up. Floor green, obstacles red, unknown grey; where the robot walked blue, the path ahead black
// and white, goal a crosshair, robot an arrow; a grid of 0.5 m. Shows all that is known, and path and goal.
figure::Image map_picture(const behavior::MapReport& report);

sim::RecordedMap recorded_map(const behavior::MapReport& report);

}  // namespace kaz::tools
