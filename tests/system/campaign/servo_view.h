// Reads the servo's state from the memory of an emulated chip, for checks. Behaviors have no access to it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "shared/board/board.h"
#include "sim/mcu/h8_mcu.h"

namespace kaz::campaign {

struct ServoState {
  std::uint32_t enabled = 0;  // bit n: joint n
  bool holding = false;
  std::array<int, KZ_JOINTS> angle{}, command{};  // 100 urad
};

// Returns the state after the last tick of the firmware.
ServoState servo_state(const sim::H8Mcu& mcu);

}  // namespace kaz::campaign
