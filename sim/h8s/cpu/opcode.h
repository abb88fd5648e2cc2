// Opcode table: encoding, text, handler and state counts of each form of an instruction.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

// Accesses of an instruction (programming manual, number of states): states = I + J + K + L + M + N with
// on-chip memory.
struct Counts {
  std::uint8_t i = 1;  // instruction fetches
  std::uint8_t j = 0;  // branch address reads, for advanced mode (half of it in normal mode)
  std::uint8_t k = 0;  // stack accesses; `k_fixed`: the same in both modes
  std::uint8_t l = 0;  // byte data
  std::uint8_t m = 0;  // word data
  std::uint8_t n = 0;  // internal
  bool k_fixed = false;
};

// `pattern` holds one character a nibble, spaces apart. 0-9 A-F stand for themselves; fields are
//   r s  byte register, source and destination     u w  word register
//   m n  long or address register, top bit 0       M N  the same, top bit 1
//   Y X  the same, any top bit
//   t T  bit number, top bit 0 and 1               p    vector number 0..3
//   i    immediate            a  absolute address          d  displacement
//   j    branch displacement  v  vector address
// `operands` is the assembler text, `%` and a letter standing for the field.
struct Opcode {
  const char* pattern;
  const char* name;
  const char* operands;
  Handler run;
  Counts counts;
};

struct Decoded {
  const Opcode* opcode = nullptr;  // null: undefined
  Insn insn{};
};

inline constexpr int kMaxUnits = 5;

// `units` holds the memory at the address and after it, as far as it exists.
Decoded decode(std::span<const std::uint16_t> units, bool normal);
// Decodes the instruction in memory that belongs to Cpu::code[index], which stays unchanged.
Decoded decode_at(const Cpu& c, std::uint32_t index);

// "mov.l @(0x10:16,er6),er0"; `address` resolves branches. Undefined: ".word 0x0001". `bytes` is set to
// its length.
std::string disassemble(std::span<const std::uint16_t> units, std::uint32_t address, int* bytes);

std::span<const Opcode> move_opcodes();
std::span<const Opcode> arithmetic_opcodes();
std::span<const Opcode> shift_opcodes();
std::span<const Opcode> bit_opcodes();
std::span<const Opcode> branch_opcodes();
std::span<const Opcode> system_opcodes();

}  // namespace kaz::h8s
