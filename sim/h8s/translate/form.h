// An instruction's operation and operands, derived from its row of the opcode table.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s::translate {

enum class Op : std::uint8_t {
  none,  // run by the interpreter
  handler,  // the interpreter's handler is called from the host code; it changes registers and flags alone
  // The same with all of the CPU's state: the handler may access the chip, or end the stretch. `detail`: it
  // always continues elsewhere, or ends the stretch.
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
  control,  // ANDC, ORC, XORC #imm to CCR; `detail` is its Control
  stm,
  ldm,
};

enum class Control : std::uint8_t { bit_and, bit_or, bit_xor };

enum class Mode : std::uint8_t {
  none,
  reg,
  imm,
  indirect,   // @ERn and @(d,ERn): the displacement is in imm
  increment,  // @ERn+
  decrement,  // @-ERn
  absolute,
};

struct Form {
  Op op = Op::none;
  std::uint8_t size = 1;    // bytes of the operand
  Mode src = Mode::none;    // its register is Insn::rs
  Mode dst = Mode::none;    // its register is Insn::rd
  std::uint8_t detail = 0;  // condition; Shift; bit operations: 1 for the inverted ones
  std::uint8_t count = 0;   // literal operand: steps of shifts, adds, inc; registers of ldm, stm
  std::uint8_t first = 0;   // ldm, stm: lowest register
  bool number_in_register = false;  // bit operations
};

// The form of a row; computed once for each.
const Form& form_of(const Opcode& opcode);

}  // namespace kaz::h8s::translate
