// The two implementations of the microcontroller, by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kaz::sim {

enum class McuKind {
  h8,      // executes the firmware image in the emulator
  native,  // runs the same C, compiled for the PC
};
inline constexpr std::array kMcuKinds{McuKind::h8, McuKind::native};

constexpr const char* to_string(McuKind kind) {
  return kind == McuKind::h8 ? "h8" : "native";
}

}  // namespace kaz::sim
