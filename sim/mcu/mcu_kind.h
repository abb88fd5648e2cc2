// Names of the two implementations of the microcontroller.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kaz::sim {

enum class McuKind {
  h8,      // executes the firmware image in the emulator
  native,  // runs the firmware's C code, compiled for the PC
};
inline constexpr std::array kMcuKinds{McuKind::h8, McuKind::native};

constexpr const char* to_string(McuKind kind) {
  return kind == McuKind::h8 ? "h8" : "native";
}

}  // namespace kaz::sim
