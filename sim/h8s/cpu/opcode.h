// Opcode table: encoding, assembler text, handler and state counts of each form of each instruction.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

// Columns of the manual's table of states (programming manual, number of states). With on-chip memory an
// instruction takes I + J + K + L + M + N states.
struct Counts {
  std::uint8_t i = 1;  // instruction fetches
  // Number of reads of a branch address in advanced mode. Normal mode has half as many reads.
  std::uint8_t j = 0;
  // Number of stack accesses in advanced mode. Normal mode has the same number if `k_fixed` is true, and half
  // as many accesses if `k_fixed` is false.
  std::uint8_t k = 0;
  std::uint8_t l = 0;  // byte data accesses
  std::uint8_t m = 0;  // word data accesses
  std::uint8_t n = 0;  // internal operations
  bool k_fixed = false;
};

// One row of the table. `pattern` has one character for each nibble of the encoding; spaces are ignored.
// 0-9 and A-F are fixed nibbles. The other letters are fields:
// - r, s: byte register, source and destination.
// - u, w: word register, source and destination.
// - m, n: long or address register, source and destination; the top bit of the nibble is 0.
// - M, N: like m, n, but the top bit of the nibble is 1. Y, X: like m, n, but the top bit may be 0 or 1.
// - t, T: bit number; the top bit of the nibble is 0 (t) or 1 (T).
// - p: vector number 0..3. v: vector address.
// - i: immediate. a: absolute address. d: displacement. j: branch displacement.
struct Opcode {
  const char* pattern;
  const char* name;
  const char* operands;  // assembler text; `%` and a letter stand for a field
  Handler run;
  Counts counts;
};

struct Decoded {
  const Opcode* opcode = nullptr;  // null: undefined instruction
  Insn insn{};
};

// Length of the longest instruction, in 16-bit units.
inline constexpr int kMaxUnits = 5;

// Decodes the instruction at the front of `units`. Near the end of memory, `units` may have fewer than
// kMaxUnits elements. If `normal` is true, the state counts apply to normal mode, otherwise to advanced mode.
Decoded decode(std::span<const std::uint16_t> units, bool normal);
// Reads and decodes the instruction at the memory address that Cpu::code[index] stands for. Does not change
// this entry.
Decoded decode_at(const Cpu& c, std::uint32_t index);

// Returns the text of one instruction, such as "mov.l @(0x10:16,er6),er0", or of an undefined instruction,
// such as ".word 0x0001". `address` is the instruction's address, from which branch targets are computed.
// `bytes` receives the instruction's length in bytes and may be null.
std::string disassemble(std::span<const std::uint16_t> units, std::uint32_t address, int* bytes);

// Each of these functions returns the rows of one group of the table.
std::span<const Opcode> move_opcodes();
std::span<const Opcode> arithmetic_opcodes();
std::span<const Opcode> shift_opcodes();
std::span<const Opcode> bit_opcodes();
std::span<const Opcode> branch_opcodes();
std::span<const Opcode> system_opcodes();

}  // namespace kaz::h8s
