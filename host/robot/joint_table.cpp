// Joint names and limits as the host sees them, from the table that the firmware uses.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/posture.h"
#include "shared/board/table.h"

namespace kaz::host {

std::span<const JointInfo, KZ_JOINTS> joint_table() {
  static const std::array<JointInfo, KZ_JOINTS> table = [] {
    std::array<JointInfo, KZ_JOINTS> joints = {{
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) {#name, 0, 0},
#include "shared/board/joints.def"
#undef KZ_JOINT
    }};
    for (std::size_t j = 0; j < joints.size(); ++j) {
      joints[j].lower_rad = static_cast<double>(kz_board_joints[j].lower) / KZ_ANGLE_PER_RAD;
      joints[j].upper_rad = static_cast<double>(kz_board_joints[j].upper) / KZ_ANGLE_PER_RAD;
    }
    return joints;
  }();
  return table;
}

std::optional<int> joint_index(std::string_view name) {
  for (int j = 0; j < KZ_JOINTS; ++j) {
    if (name == joint_table()[static_cast<std::size_t>(j)].name) return j;
  }
  return std::nullopt;
}

}  // namespace kaz::host
