// Types of the CPU that users of the emulator see: time, engines, registers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace kaz::h8s {

// Time in periods of the system clock ("states" in the manuals).
using States = std::int64_t;
inline constexpr States kNever = std::numeric_limits<States>::max();

// How instructions are executed. All three produce the same registers, memory and time at every
// instruction boundary; only the speed differs.
enum class Engine {
  reference,    // decodes each instruction from memory every time it runs: slow, checks the others
  interpreter,  // decodes each instruction once
  translator,  // interpreter, plus host code for hot blocks; needs x86-64 and asmjit at build time,
               // otherwise the same as `interpreter`
};

// "reference", "interpreter" or "translator".
const char* name_of(Engine engine);

// The programmer's registers (H8S/2000 Programming Model).
struct Registers {
  std::array<std::uint32_t, 8> er{};  // ER7 is the stack pointer
  std::uint32_t pc = 0;               // address of the next instruction
  std::uint8_t ccr = 0;               // bits 7 to 0: I UI H U N Z V C
  std::uint8_t exr = 0x7f;
  bool operator==(const Registers&) const = default;
};

}  // namespace kaz::h8s
