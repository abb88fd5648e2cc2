// Names of Kaz's joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "shared/board/board.h"

namespace kaz::sim {

// Returns the names of the joints in the order of shared/board/joints.def.
const std::array<std::string, KZ_JOINTS>& joint_names();

// An error about the names of a robot's joints.
struct JointNameError {
  int joint = -1;  // index; -1: the error is about the whole robot
  std::string text;
};

// Checks the names of the joints with a motor. A robot needs at least one joint. A robot with 15 or more of
// Kaz's joint names is a Kaz, and must have all of them and no others.
std::vector<JointNameError> joint_name_errors(std::span<const std::string> names);

}  // namespace kaz::sim
