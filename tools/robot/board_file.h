// Adapts a robot's joint limits to the channels of the servo board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/limited_urdf.h"

namespace kaz::tools {

// Returns the joints whose limits the servo board does not permit, with limits that it permits. The n-th
// joint that moves has the n-th channel. A joint becomes fixed if no channel is left, or if its range and the
// channel's range overlap by less than 0.1 rad. Empty for Kaz.
std::vector<sim::JointRange> limits_for_board(const sim::RobotModel& robot);

// Name of the file that write_board_file() writes: NAME.board.urdf for NAME.urdf.
std::string board_file_name(const std::string& urdf_path);

// Writes the robot with these limits as a URDF into the same folder. Keeps a file that is newer than
// `urdf_path`. Returns one line that says what was written, or an empty text.
Result<std::string> write_board_file(const std::string& urdf_path,
                                     const std::vector<sim::JointRange>& limits);

}  // namespace kaz::tools
