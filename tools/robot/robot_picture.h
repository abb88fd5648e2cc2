// Picture of a robot's description.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "sim/body/description/robot_model.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// Draws the robot at the zero posture, with its visuals. Links without visuals show their collision shapes,
// except hulls. Returns Fault::usage if a mesh cannot be read, or if the robot has nothing to draw.
Result<vision::Image> robot_picture(const sim::RobotModel& robot, int width);

}  // namespace kaz::tools
