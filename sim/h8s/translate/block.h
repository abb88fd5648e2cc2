// Basic block of guest instructions with side exits, and the liveness of the flags in this block.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/h8s/cpu/cpu.h"
#include "sim/h8s/translate/form.h"

namespace kaz::h8s::translate {

// A mask of flags has one bit for each flag.
inline constexpr unsigned kN = 1, kZ = 2, kV = 4, kH = 8, kC = 16, kAllFlags = 31;
inline constexpr int kFlags = 5;

// A register ERn or a part of it.
struct Part {
  std::uint8_t reg = 0;    // n
  std::uint8_t shift = 0;  // lowest bit of the part in ERn: 0, 8 or 16
  std::uint8_t size = 4;   // bytes
  bool operator==(const Part&) const = default;
};

// Returns the part at a byte offset into the register file (Insn::rs, Insn::rd).
Part part_at(unsigned offset, unsigned size);

// Methods to recompute the flags from registers after an instruction.
enum class From : std::uint8_t {
  nothing,
  result,  // N and Z from `r`, V is 0
  add,     // r := r + b
  sub,     // r := r - b
  cmp,     // like sub, but r is unchanged
  neg,     // r := 0 - r
  zero,    // a register minus itself
  bit,     // Z from r & b
};

// Operation and operands from which flags can be recomputed. If `immediate` is true, the operand b is the
// number `value`. Otherwise the operand b is the register part `b`.
struct Definition {
  From from = From::nothing;
  Part r{};
  bool immediate = true;
  Part b{};
  std::uint32_t value = 0;
};

// One instruction of a block.
struct Step {
  Form form;
  Insn insn;                 // decoded instruction; displacements of branches are in bytes
  std::uint32_t index = 0;   // index of the instruction in Cpu::code
  std::uint32_t target = 0;  // branch or jump to a fixed address: index of the target in Cpu::code
  std::uint32_t before = 0;  // sum of the states of the earlier steps

  // The next four members are masks of flags.
  unsigned sets = 0;         // flags that the step writes
  unsigned recoverable = 0;  // subset of `sets`: flags that can be recomputed from `definition`
  unsigned uses = 0;         // flags that the step reads from memory
  unsigned keep = 0;         // flags that the step sets and must store to memory
  bool exits = false;        // the block may be left before this step has any effect
  // The step accesses an I/O register; the block may be left after the step.
  bool io = false;
  Definition definition;
  // For each flag: index of the nearest earlier step that sets the flag. If no earlier step sets the flag,
  // the index is -1.
  std::array<std::int16_t, kFlags> set_by{};
};

// Reason why a block ends.
enum class End : std::uint8_t {
  next,       // execution continues at `after`
  interpret,  // the interpreter runs the instruction at `after`
  jump,       // the last step leaves the block
};

struct Block {
  std::uint32_t start = 0;  // index in Cpu::code
  std::uint32_t after = 0;  // index in Cpu::code after the last step
  End end = End::next;
  std::vector<Step> steps;
  std::uint32_t bound = 0;   // number of states of all steps but the last
  std::uint32_t states = 0;  // number of states of all steps
  unsigned live = 0;         // flags that must be in memory at entry
};

// Index that stands for an address without memory.
inline constexpr std::uint32_t kNowhere = 0xffffffff;

// Returns a mask of the registers ERn that a step may write.
unsigned registers_written_by(const Step& s);

// Access of a step to memory through a register. The access begins at register + `displacement`.
struct Access {
  unsigned reg = 0;
  std::int32_t displacement = 0;
  std::int32_t bytes = 0;  // 0: the step has no access through a register
  std::int32_t moves = 0;  // number that the step adds to the register
  bool words = false;      // the address must be even
};
Access access_of(const Step& s);

// Returns the mask of flags that condition 0..15 of Bcc reads.
unsigned flags_of_condition(unsigned condition);

// Finds the step from which step `k` can recompute all flags of the mask `wanted`. The found step is the last
// step before step `k` that sets these flags. The `definition` of the found step can recompute these flags.
// No step between the found step and step `k` changes the registers of this definition. Returns the index of
// the found step, or -1 if there is no such step.
int common_source(const Block& block, std::size_t k, unsigned wanted);

// Memory region that an access of `size` bytes uses. The address of the access is known at translation time.
enum class Place : std::uint8_t { ram, short_ram, flash, elsewhere };
Place place_of(const Cpu& c, std::uint32_t address, unsigned size);

// Returns the block that begins at index `start` of Cpu::code. The block has no steps if the first
// instruction cannot be translated. If `known(index)` is true for the index of a later instruction, the
// block ends before this instruction. For example, known() can be true for the first instruction of another
// block.
template <class Known>
Block find_block(Cpu& c, std::uint32_t start, const Known& known);

// Fills `step` with the instruction at `index`, for find_block. Returns false if the block must end before
// that instruction.
bool take_step(Cpu& c, std::uint32_t index, Step& step);
// Computes Block::live and the members of steps that depend on the whole block.
void settle_flags(Block& block);

// Limits of one block.
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
