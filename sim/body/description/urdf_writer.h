// Writes a robot model as URDF, for viewers and recordings of robots in MJCF.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {

// Returns a URDF that load_robot() reads as the same model. Differences: names of visuals, numbers of links,
// and notes. Frames that are not links of the model become links at fixed joints. The collision shapes of a
// link that have another friction than its first shape become such links, too. Infinite limits of speed and
// torque are written as 0. Paths of meshes in `folder`, which is absolute, are relative to it.
std::string urdf_of(const RobotModel& robot, const std::string& folder);

// Returns the URDF of a robot file. For a URDF, this is the file itself. For an MJCF, it is urdf_of() without
// missing meshes, for a URDF in the same folder. `loaded`: the robot that load_robot() has read from the
// file. Null: the function reads it. Errors: as load_robot().
Result<std::string> robot_urdf(const std::string& path, const RobotModel* loaded = nullptr);

}  // namespace kaz::sim
