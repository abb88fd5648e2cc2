// Operation and operands of an instruction for the translator, derived from the opcode table.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s::translate {

enum class Op : std::uint8_t {
  none,     // not translated: the block ends before this instruction
  handler,  // calls the interpreter's handler, which changes only registers and flags
  // Calls the interpreter's handler. The handler gets the complete CPU state, because the handler may access
  // the chip or call end_stretch(). If `detail` is 1, the block ends after this instruction.
  interpreted,
  nop,
  mov,
  add,
  sub,
  cmp,
  bit_and,
  bit_or,
  bit_xor,
  addx,
  subx,
  adds,
  inc,
  dec,
  neg,
  bit_not,
  extu,
  exts,
  shift,
  mulxu,
  mulxs,
  bset,
  bnot,
  bclr,
  bst,
  btst,
  bor,
  bxor,
  band,
  bld,
  bcc,
  bsr,
  jmp,
  jsr,
  rts,
  rte,
  control,  // ANDC, ORC, XORC #imm to CCR; `detail` is a value of the enum Control
  stm,
  ldm,
};

// Operation of Op::control.
enum class Control : std::uint8_t { bit_and, bit_or, bit_xor };

// Addressing mode of an operand.
enum class Mode : std::uint8_t {
  none,
  reg,
  imm,
  indirect,   // @ERn and @(d,ERn); the displacement is Insn::imm
  increment,  // @ERn+
  decrement,  // @-ERn
  absolute,
};

// Decoded form of one row of the opcode table.
struct Form {
  Op op = Op::none;
  std::uint8_t size = 1;  // operand size, bytes
  Mode src = Mode::none;  // source operand; its register is Insn::rs
  Mode dst = Mode::none;  // destination operand; its register is Insn::rd
  // The meaning depends on `op`. bcc: number of the condition. shift: a value of Shift. control: a value of
  // Control. adds: 1 for SUBS. Bit operations: 1 for the inverting form (such as BIST).
  std::uint8_t detail = 0;
  // shift, adds, inc, dec: the literal operand. ldm, stm: the number of registers.
  std::uint8_t count = 0;
  std::uint8_t first = 0;           // ldm, stm: lowest register
  bool number_in_register = false;  // bit operations: the bit number is in a register
};

// Returns the form of a row of the opcode table. The form of each row is computed only once.
const Form& form_of(const Opcode& opcode);

}  // namespace kaz::h8s::translate
