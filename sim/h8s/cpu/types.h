// Public types of the CPU: time, execution engines, registers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace kaz::h8s {

// Time, in periods of the system clock ("states" in the manuals).
using States = std::int64_t;
inline constexpr States kNever = std::numeric_limits<States>::max();

// How instructions are executed. At every instruction boundary all three engines have the same registers,
// memory and time. The engines differ only in speed.
enum class Engine {
  // Decodes an instruction each time the instruction runs; slow. Tests compare the other engines with this
  // engine.
  reference,
  interpreter,  // decodes each instruction once
  // Interpreter that runs hot blocks as host code. A build without x86-64 or asmjit uses `interpreter`
  // instead.
  translator,
};

// Returns "reference", "interpreter" or "translator".
const char* name_of(Engine engine);

// CPU registers as a program sees them (H8S/2000 programming manual).
struct Registers {
  std::array<std::uint32_t, 8> er{};  // ER7 is the stack pointer
  std::uint32_t pc = 0;               // address of the next instruction
  std::uint8_t ccr = 0;               // bits 7 to 0: I UI H U N Z V C
  std::uint8_t exr = 0x7f;
  bool operator==(const Registers&) const = default;
};

}  // namespace kaz::h8s
