// A basic block with side exits, and the liveness of its flags.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/h8s/cpu/cpu.h"
#include "sim/h8s/translate/form.h"

namespace kaz::h8s::translate {

// Flags as bits of a mask.
inline constexpr unsigned kN = 1, kZ = 2, kV = 4, kH = 8, kC = 16, kAllFlags = 31;
inline constexpr int kFlags = 5;

// A register or a part of one: byte and word registers start at bit 0, 8 or 16.
struct Part {
  std::uint8_t reg = 0;
  std::uint8_t shift = 0;
  std::uint8_t size = 4;
  bool operator==(const Part&) const = default;
};

// The part at an offset into the register file (Insn::rs, Insn::rd).
Part part_at(unsigned offset, unsigned size);

// How flags can be recomputed from registers after the instruction.
enum class From : std::uint8_t {
  nothing,
  result,  // N and Z of `r`, V is 0
  add,     // r := r + b
  sub,     // r := r - b
  cmp,     // r - b, r unchanged
  neg,     // r := 0 - r
  zero,    // a register minus itself
  bit,     // Z of r & b
};

struct Definition {
  From from = From::nothing;
  Part r{};
  bool immediate = true;  // b is `value`, else the register `b`
  Part b{};
  std::uint32_t value = 0;
};

struct Step {
  Form form;
  Insn insn;  // as decoded, branches with their displacement in bytes
  std::uint32_t index = 0;
  std::uint32_t target = 0;  // branches and jumps to known places: index in Cpu::code
  std::uint32_t before = 0;  // states of the steps before

  unsigned sets = 0;         // flags written
  unsigned recoverable = 0;  // of them, those that can be recomputed by `definition`
  unsigned uses = 0;         // flags read from memory
  unsigned keep = 0;         // of `sets`: must be in memory after the step
  bool exits = false;        // the block may be left before this step has any effect
  bool io = false;           // accesses a register of the chip; the block may be left after it
  Definition definition;
  // For each flag the last earlier step that set it; -1: none in the block.
  std::array<std::int16_t, kFlags> set_by{};
};

// Why a block ends.
enum class End : std::uint8_t {
  next,       // execution continues at `after`
  interpret,  // the interpreter runs the instruction at `after`
  jump,       // the last step leaves the block
};

struct Block {
  std::uint32_t start = 0;
  std::uint32_t after = 0;
  End end = End::next;
  std::vector<Step> steps;
  std::uint32_t bound = 0;   // states before the last step
  std::uint32_t states = 0;  // of all
  unsigned live = 0;         // flags that must be in memory when it is entered
};

inline constexpr std::uint32_t kNowhere = 0xffffffff;

// Registers that a step writes, by bits.
unsigned registers_written_by(const Step& s);

// A step's access to memory through a register, beginning `displacement` from it. The step then adds `moves`
// to the register.
struct Access {
  unsigned reg = 0;
  std::int32_t displacement = 0;
  std::int32_t bytes = 0;  // 0: there is none
  std::int32_t moves = 0;
  bool words = false;  // must be at an even address
};
Access access_of(const Step& s);

// Flags that a condition of Bcc reads.
unsigned flags_of_condition(unsigned condition);

// The earlier step from whose registers, still unchanged at step `k`, all flags `wanted` can be
// recomputed; -1: none.
int common_source(const Block& block, std::size_t k, unsigned wanted);

// Memory region of an address known at translation time.
enum class Place : std::uint8_t { ram, short_ram, flash, elsewhere };
Place place_of(const Cpu& c, std::uint32_t address, unsigned size);

// The block that begins at `start` of Cpu::code; without steps if its first instruction cannot be
// translated. `known(index)`: whether another block already begins there.
template <class Known>
Block find_block(Cpu& c, std::uint32_t start, const Known& known);

// Adds one instruction for find_block; false: the interpreter must run it.
bool take_step(Cpu& c, std::uint32_t index, Step& step);
// Computes the members of steps that depend on the whole block.
void settle_flags(Block& block);

inline constexpr std::size_t kMaxSteps = 16;
inline constexpr std::uint32_t kMaxStates = 64;

template <class Known>
Block find_block(Cpu& c, std::uint32_t start, const Known& known) {
  Block block;
  block.start = block.after = start;
  for (;;) {
    if (block.steps.size() >= kMaxSteps || block.states >= kMaxStates) break;
    if (!block.steps.empty() && known(block.after)) break;
    Step step;
    if (!take_step(c, block.after, step)) {
      block.end = End::interpret;
      break;
    }
    step.before = block.bound = block.states;
    block.states += step.insn.states;
    block.after += step.insn.units;
    const Op op = step.form.op;
    const bool leaves = op == Op::bsr || op == Op::jmp || op == Op::jsr || op == Op::rts ||
                        (op == Op::bcc && step.form.detail == 0) || op == Op::rte ||
                        (op == Op::interpreted && step.form.detail != 0);
    block.steps.push_back(step);
    if (leaves) {
      block.end = End::jump;
      break;
    }
  }
  settle_flags(block);
  return block;
}

}  // namespace kaz::h8s::translate
