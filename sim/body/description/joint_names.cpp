// Names of Kaz's joints.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/joint_names.h"

namespace kaz::sim {

const std::array<std::string, KZ_JOINTS>& joint_names() {
  static const std::array<std::string, KZ_JOINTS> names{
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) #name,
#include "shared/board/joints.def"
#undef KZ_JOINT
  };
  return names;
}

}  // namespace kaz::sim
