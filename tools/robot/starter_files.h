// First versions of the files that belong to a robot's description.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/body/description/robot_model.h"

namespace kaz::tools {

// Returns the text of a bus.json that gives each joint a servo: model STS3215, ids 1, 2, 3 and so on, zero in
// the middle of the turn.
std::string starter_bus_file(const sim::RobotModel& robot);

// Writes bus.json, motor.xml and sensors.xml into the folder of `urdf_path`, except files that exist. The
// last two are copies of Kaz's files. Returns the names of the written files.
Result<std::vector<std::string>> write_starter_files(const sim::RobotModel& robot,
                                                     const std::string& urdf_path);

}  // namespace kaz::tools
