// Emits x86-64 host code for blocks of guest instructions, with asmjit.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <asmjit/x86.h>

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "sim/h8s/translate/block.h"

namespace kaz::h8s::translate {

// Record of the translator for one entry of Cpu::code.
struct Entry {
  const void* code = nullptr;  // host code of the block that begins at this entry; null: no code
  bool covered = false;        // the entry is part of a translated instruction
  std::uint32_t count = 0;     // number of jumps to this entry
};
static_assert(sizeof(void*) != 8 || sizeof(Entry) == 16);

// Record for the near-end version of a block. The near-end version is host code that runs shortly before
// Cpu::stop. This version runs if the number of states until Cpu::stop is at most Block::bound.
struct NearEnd {
  // Host code of the near-end version; null: no code. Between two instructions, the host code checks whether
  // time is left until Cpu::stop.
  const void* code = nullptr;
  std::uint16_t bound = 0;  // Block::bound of the block that begins at this entry
  std::uint16_t count = 0;  // number of times that the block did not fit into the time left
};

namespace host = asmjit::x86;

// Host registers in translated code. ER0 to ER3 are in registers whose second byte is addressable.
// - rax rbx rcx rdx r8 r9 r10 r11: ER0..ER7, upper halves zero.
// - rbp: Cpu.
// - r12: number of states until Cpu::stop, minus Block::bound of the current block.
// - r13: instructions executed since the code was entered.
// - r14: guest RAM.
// - rsi rdi r15: scratch within one instruction.
inline constexpr host::Gp kCpu = host::rbp, kLeft = host::r12, kExecuted = host::r13,
                          kRamBase = host::r14;

// Byte offsets of the flags in Cpu.
inline constexpr std::size_t kOffsetN = offsetof(Cpu, flags) + offsetof(Flags, n);
inline constexpr std::size_t kOffsetZ = offsetof(Cpu, flags) + offsetof(Flags, z);
inline constexpr std::size_t kOffsetV = offsetof(Cpu, flags) + offsetof(Flags, v);
inline constexpr std::size_t kOffsetH = offsetof(Cpu, flags) + offsetof(Flags, h);
inline constexpr std::size_t kOffsetC = offsetof(Cpu, flags) + offsetof(Flags, c);

// Return values of translated code. kInterpret: the interpreter must run the instruction at Cpu::ip.
inline constexpr std::uint32_t kGoOn = 0, kInterpret = 1;

// Host code shared by all blocks: entry, exits and calls of handlers (gate.cpp).
struct Gate {
  const void* enter = nullptr;  // called as std::uint32_t(Cpu*, const void* entry)
  // Exit from translated code. Arguments: edi is the index of the next instruction, esi is the return value.
  const void* leave = nullptr;
  // Subroutine that runs the handler of an instruction. Arguments: rdi is the address of the instruction's
  // entry in Cpu::code. rsi is Block::bound minus the number of states from the start of the block to the end
  // of the instruction. Results: kLeft is the return value of run_handler(). The host's flags are the result
  // of comparing kLeft with 0. If kLeft is 0 or less, Cpu contains the complete state, and the host code must
  // leave the block.
  const void* interpret = nullptr;
  // Subroutines that only access an I/O register. Arguments: rdi and rsi have the same meaning as for
  // `interpret`. For a store, r15 is the value to store. Results: a load returns the loaded value in edi. If
  // the access has wait states, kLeft is reduced by the number of wait states. After the subroutine, Cpu does
  // not contain the complete state.
  const void* load8 = nullptr;
  const void* load16 = nullptr;
  const void* store8 = nullptr;
  const void* store16 = nullptr;
  // Second exit from translated code. Before the jump to this exit, Cpu must contain the complete state. This
  // exit only adds kExecuted to Cpu::executed.
  const void* leave_complete = nullptr;
  // Jump target for an interpreted instruction that ends its block, such as TRAPA. Arguments: rdi and rsi
  // have the same meaning as for `interpret`. Runs the instruction's handler, then the block at the address
  // in Cpu::ip. If there is no block at this address, jumps to `leave_complete`. Also jumps to
  // `leave_complete` if the time Cpu::stop is reached, or if the handler has discarded the translated code.
  const void* go_elsewhere = nullptr;
};
struct GateLabels {
  asmjit::Label leave, interpret, load8, load16, store8, store16, leave_complete, go_elsewhere;
};
void emit_gate(host::Assembler& a, const GateLabels& labels, const Entry* entries);

// Runs the handler of `ip`, with the complete state in `c`. If the CPU must not continue with the next
// instruction of the block, returns 0. Otherwise returns the number of states from the next instruction to
// Cpu::stop, minus `rest`. `rest` is the argument rsi of Gate::interpret. If the result is 0 or less, the
// host code must leave the block.
std::int64_t run_handler(Cpu& c, const Insn* ip, std::int64_t rest);
// Runs the handler of `ip`, with the complete state in `c`. The instruction ends its block. Returns the host
// code of the block at the new address in Cpu::ip, or null if execution must leave the translated code.
const void* run_handler_elsewhere(Cpu& c, const Insn* ip, const Entry* entries);

// Emits the blocks of one translation unit. The blocks jump to each other directly. `k` is the index of a
// step in the current block, `n` is the index of a block in the unit.
class Emitter {
 public:
  Emitter(Cpu& cpu, asmjit::CodeHolder& code, Entry* entries, NearEnd* near_ends, const Gate& gate);

  void emit(const std::vector<Block>& blocks);
  // Emits the near-end version of a block. This version is the only block of its translation unit. At the
  // entry of this version, kLeft is the number of states until Cpu::stop: Block::bound is not subtracted.
  void emit_near_end(const Block& block);
  // Returns the offset of the entry through which code outside the unit enters block `n`.
  std::uint64_t entry_offset(const asmjit::CodeHolder& code, std::size_t n) const;

 private:
  using Fetch = std::function<void(const host::Mem&)>;
  // For each flag: the step whose definition recomputes the flag; -1: the flag is in memory.
  using Pending = std::array<std::int16_t, kFlags>;
  using Again = std::map<std::size_t, asmjit::Label>;  // label for each step

  // --- blocks and exits (emit_branch.cpp)
  void emit_block(std::size_t n);
  void emit_end();
  void emit_step(std::size_t k);
  void emit_again(std::size_t n, const Again& again, const Pending& pending);
  void emit_cold();
  // Continues with the near-end version of block `n`, or leaves the translated code if that version does not
  // exist.
  void emit_late(std::size_t n);
  // Leaves the block after step k if no time is left.
  void leave_at_end(std::size_t k);
  // Returns the label of the exit after step k.
  asmjit::Label after(std::size_t k);
  void emit_condition(std::size_t k, unsigned native);
  void emit_call(std::size_t k);
  void emit_jump(std::size_t k);
  void emit_return(std::size_t k);
  // --- interrupt mask and return from exceptions (emit_control.cpp)
  void emit_control(std::size_t k);
  void emit_exception_return(std::size_t k);
  // Exits before step k if an interrupt request is pending or if no time is left after step k.
  void leave_for_interrupts(std::size_t k);
  // Converts the address in r15 to twice the index of this address in Cpu::code. Exits before the step if the
  // address has no index.
  void find_target(std::size_t k);
  // Emits the jump from step k to a block. r15 contains twice the index of this block in Cpu::code.
  void leave_through_table(std::size_t k);
  // Emits the jump to the block at index `target` of Cpu::code. Before the jump, the first `steps` steps of
  // the current block have run.
  void emit_edge(std::size_t steps, std::uint32_t target);
  void emit_out(std::uint32_t index, std::uint32_t answer);
  // Returns the label of the exit that is taken before step k has any effect.
  asmjit::Label before(std::size_t k);
  std::uint32_t states_before(std::size_t k) const;
  void emit_handler(const Step& s);
  void emit_interpreted(std::size_t k);
  // --- I/O registers (emit_memory.cpp)
  void emit_access(std::size_t k, const void* gate);
  void load_io(std::size_t k);
  void store_io(std::size_t k);
  // Leaves the block after step k if the rest of the block no longer fits into the time left.
  void leave_after(std::size_t k);

  // --- flags (emit_flags.cpp)
  void store_flags(const Definition& d, unsigned mask);
  void store_pending(const Pending& pending, const Block& block, unsigned mask);
  void store_carry(bool inverted = false);
  // Emits code that sets the host's flags to the guest flags that `d` defines.
  void compare_again(const Definition& d);

  // --- registers (emit_registers.cpp)
  static host::Gp gp(unsigned reg);  // the host register of ERn, 32 bits
  // Host register for the low `size` bytes of ERn.
  static host::Gp low(unsigned reg, unsigned size);
  static host::Gp sized(const host::Gp& r, unsigned size);
  void get(const host::Gp& to, Part part);
  void put(Part part, const host::Gp& from);
  // Loads a part into the highest bits of the 32-bit register `to`. The bits below the part are 0.
  void get_up(const host::Gp& to, Part part);
  void get_operand_up(const host::Gp& to, const Definition& d);
  // turn() rotates the register so that the part is at bit 0. turn_back() reverses this rotation.
  void turn(Part part);
  void turn_back(Part part);
  static bool high_byte(Part part) { return part.shift == 8 && part.reg < 4; }
  static host::Gp high(unsigned reg);

  // --- memory (emit_memory.cpp)
  host::Mem flag(std::size_t offset, unsigned size = 4) const;
  Place address(const Step& s, Mode mode, unsigned reg, unsigned size, std::uint32_t bytes,
                host::Mem& at);
  host::Mem ram_check(unsigned size, std::uint32_t bytes, const asmjit::Label& outside);
  // Returns the host operand for an access of step k through a register. If an earlier range check covers the
  // access, emits no check. Otherwise emits one check for this access and later accesses of the block.
  // Returns nullopt if no range check can cover the access.
  std::optional<host::Mem> proved(std::size_t k, unsigned size);
  bool check_together(std::size_t k);
  void move_proofs(const Step& s);
  void load(std::size_t k, Mode mode, unsigned reg, unsigned size, const Fetch& fetch);
  host::Mem writable(std::size_t k, Mode mode, unsigned reg, unsigned size, std::uint32_t bytes);
  void fetch_big(const host::Gp& to, const host::Mem& at, unsigned size);
  void store_big(const host::Mem& at, const host::Gp& from, unsigned size);
  void emit_load(std::size_t k);
  void emit_store(std::size_t k);
  void emit_multiple(std::size_t k);

  // --- instructions (emit_arithmetic.cpp, emit_bits.cpp)
  void emit_mov(std::size_t k);
  void emit_two(const Step& s);
  void store_doubled(Part part, unsigned keep);
  void emit_with_carry(const Step& s);
  void emit_one(const Step& s);
  void emit_extend(const Step& s);
  void emit_multiply(const Step& s);
  void emit_shift(const Step& s);
  void emit_bit(std::size_t k);
  void bit_in_register(const Step& s, const host::Gp& r, unsigned shift);

  Cpu& c_;
  host::Assembler a_;
  Entry* entries_;
  NearEnd* near_ends_;
  Gate gate_;
  bool movbe_;

  const std::vector<Block>* blocks_ = nullptr;
  const Block* block_ = nullptr;
  std::map<std::uint32_t, std::size_t> block_at_;
  // For each block: jump target that skips the check whether time is left until Cpu::stop.
  std::vector<asmjit::Label> inside_;
  std::vector<asmjit::Label> outside_;  // entries of the blocks for code outside the unit
  std::vector<asmjit::Label> late_;     // for each block: code that emit_late() emits
  std::vector<std::function<void()>> side_, cold_;

  Pending pending_{};
  // Result of a range check in the current block: each address from A to B is in RAM. A is register + `low`,
  // and B is register + `high` - 1. One check can cover several accesses. If this check fails, a second
  // version of the block's code runs. The second version checks each access.
  struct Proof {
    std::int32_t low = 0, high = 0;
    bool even = false;  // the value of the register is even
  };
  std::array<Proof, 8> proofs_{};
  Again again_;            // label in the second version for each step whose check can fail
  bool second_ = false;    // the second version is being emitted
  bool near_end_ = false;  // the time left is checked after each step

  asmjit::Label before_;
  bool has_before_ = false;
  unsigned native_ = 0;  // guest flags that are now in the host's flags
  unsigned stored_ = 0;  // flags of Step::keep that are already in memory
};

}  // namespace kaz::h8s::translate
