// Names of Kaz's joints.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/joint_names.h"

#include <algorithm>

namespace kaz::sim {

const std::array<std::string, KZ_JOINTS>& joint_names() {
  static const std::array<std::string, KZ_JOINTS> names{
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) #name,
#include "shared/board/joints.def"
#undef KZ_JOINT
  };
  return names;
}

std::vector<JointNameError> joint_name_errors(std::span<const std::string> names) {
  constexpr std::ptrdiff_t kNamesOfKaz = 15;
  if (names.empty()) return {{-1, "robot has no revolute joint; a robot needs at least one"}};
  const auto& table = joint_names();
  const auto shared = std::ranges::count_if(
      table, [&](const std::string& name) { return std::ranges::count(names, name) > 0; });
  std::vector<JointNameError> errors;
  if (shared < kNamesOfKaz) return errors;
  for (const std::string& name : table) {
    if (std::ranges::count(names, name) == 0)
      errors.push_back({-1, "robot has no joint `" + name + "`, but " + std::to_string(shared) +
                                " other joints of Kaz; a Kaz has all joints of "
                                "shared/board/joints.def: add the missing joint, or rename the "
                                "others if the robot is not a Kaz"});
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::ranges::count(table, names[i]) == 0)
      errors.push_back(
          {static_cast<int>(i),
           "joint `" + names[i] +
               "` is not a joint of the servo board (shared/board/joints.def): correct "
               "the joint's name, or make the joint fixed"});
  }
  return errors;
}

}  // namespace kaz::sim
