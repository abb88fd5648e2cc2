// Host code for blocks of guest instructions: x86-64, by asmjit.
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

// The translator's record of one entry of Cpu::code.
struct Entry {
  const void* code = nullptr;  // host code of the block that begins here
  bool covered = false;        // part of a translated instruction
  std::uint32_t count = 0;     // times reached by a jump
};
static_assert(sizeof(void*) != 8 || sizeof(Entry) == 16);

// The same beside it, for the end of a stretch: less time is left than the block's bound.
struct NearEnd {
  const void* code = nullptr;  // code of the instructions here that checks the time left after each
  std::uint16_t bound = 0;     // of the block that begins here
  std::uint16_t count = 0;     // times that the block was too long
};

namespace host = asmjit::x86;

// Registers inside translated code. ER0 to ER3 are in registers whose second bytes can be addressed.
//   rax rbx rcx rdx r8 r9 r10 r11   ER0..ER7, upper halves zero
//   rbp   Cpu
//   r12   states left until Cpu::stop, minus the bound of the current block
//   r13   instructions executed since the code was entered
//   r14   guest RAM
//   rsi rdi r15   free within one instruction
inline constexpr host::Gp kCpu = host::rbp, kLeft = host::r12, kExecuted = host::r13,
                          kRamBase = host::r14;

// Places of the flags in Cpu, bytes.
inline constexpr std::size_t kOffsetN = offsetof(Cpu, flags) + offsetof(Flags, n);
inline constexpr std::size_t kOffsetZ = offsetof(Cpu, flags) + offsetof(Flags, z);
inline constexpr std::size_t kOffsetV = offsetof(Cpu, flags) + offsetof(Flags, v);
inline constexpr std::size_t kOffsetH = offsetof(Cpu, flags) + offsetof(Flags, h);
inline constexpr std::size_t kOffsetC = offsetof(Cpu, flags) + offsetof(Flags, c);

// What translated code returns: whether the interpreter must run the instruction at Cpu::ip.
inline constexpr std::uint32_t kGoOn = 0, kInterpret = 1;

// Code shared by all blocks.
struct Gate {
  const void* enter = nullptr;  // called as std::uint32_t(Cpu*, const void* entry)
  const void* leave = nullptr;  // index of the next instruction in edi, the return value in esi
  // Called with an instruction of Cpu::code in rdi and in rsi the states from its end to the block's
  // bound: runs its handler. Afterwards kLeft is as the next instruction expects it, and the host's flags
  // compare it with 0; if it is not greater, Cpu holds the whole state, and the block must be left.
  const void* interpret = nullptr;
  // Accesses of an instruction to a register of the chip, as `interpret`, without its other effects: it is in
  // rdi, rsi, a value that is stored in r15. A value that is loaded is returned in edi. Cpu then does not
  // hold the whole state.
  const void* load8 = nullptr;
  const void* load16 = nullptr;
  const void* store8 = nullptr;
  const void* store16 = nullptr;
  const void* leave_complete = nullptr;  // as `leave`, when Cpu holds all but kExecuted
  // Jumped to, as `interpret`, by instructions that continue elsewhere: goes on with the block there.
  const void* go_elsewhere = nullptr;
};
struct GateLabels {
  asmjit::Label leave, interpret, load8, load16, store8, store16, leave_complete, go_elsewhere;
};
void emit_gate(host::Assembler& a, const GateLabels& labels, const Entry* entries);

// Runs the handler of `ip`, with the CPU's state in `c`. Returns the states left at the next instruction,
// minus `rest`; 0 if that does not follow in the block.
std::int64_t run_handler(Cpu& c, const Insn* ip, std::int64_t rest);
// The same for an instruction that continues elsewhere. Returns the code there; null: the block must be left.
const void* run_handler_elsewhere(Cpu& c, const Insn* ip, const Entry* entries);

// All blocks of one translation unit, which jump to each other directly.
class Emitter {
 public:
  Emitter(Cpu& cpu, asmjit::CodeHolder& code, Entry* entries, NearEnd* near_ends, const Gate& gate);

  void emit(const std::vector<Block>& blocks);
  // A block for the end of a stretch, alone in its unit. Entered with the time left in kLeft, by itself.
  void emit_near_end(const Block& block);
  // Offset of the code for entering block `n` from outside.
  std::uint64_t entry_offset(const asmjit::CodeHolder& code, std::size_t n) const;

 private:
  using Fetch = std::function<void(const host::Mem&)>;
  // For each flag the step from which it can be recomputed; -1: it is in memory.
  using Pending = std::array<std::int16_t, kFlags>;
  using Again = std::map<std::size_t, asmjit::Label>;  // by steps

  // --- blocks and exits (emit_branch.cpp)
  void emit_block(std::size_t n);
  void emit_end();
  void emit_step(std::size_t k);
  void emit_again(std::size_t n, const Again& again, const Pending& pending);
  void emit_cold();
  // Block `n` is too long for the time left: goes on with its version for that, if there is one.
  void emit_late(std::size_t n);
  // Leaves the block after step k if no time is left.
  void leave_at_end(std::size_t k);
  // The exit after step k.
  asmjit::Label after(std::size_t k);
  void emit_condition(std::size_t k, unsigned native);
  void emit_call(std::size_t k);
  void emit_jump(std::size_t k);
  void emit_return(std::size_t k);
  // --- interrupt mask and return from exceptions (emit_control.cpp)
  void emit_control(std::size_t k);
  void emit_exception_return(std::size_t k);
  // Exits before step k if the boundary after it is one at which an interrupt may be accepted or held off.
  void leave_for_interrupts(std::size_t k);
  // r15 (address, even) becomes twice the index of its code; exits before the step if it has none.
  void find_target(std::size_t k);
  void leave_through_table(std::size_t k);
  // Edge to `target` after `steps` steps have run.
  void emit_edge(std::size_t steps, std::uint32_t target);
  void emit_out(std::uint32_t index, std::uint32_t answer);
  // Label of the exit before step k has any effect.
  asmjit::Label before(std::size_t k);
  std::uint32_t states_before(std::size_t k) const;
  void emit_handler(const Step& s);
  void emit_interpreted(std::size_t k);
  // --- registers of the chip (emit_memory.cpp)
  void emit_access(std::size_t k, const void* gate);
  void load_io(std::size_t k);
  void store_io(std::size_t k);
  // After a step: leaves the block if the time left is no longer sufficient for it.
  void leave_after(std::size_t k);

  // --- flags (emit_flags.cpp)
  void store_flags(const Definition& d, unsigned mask);
  void store_pending(const Pending& pending, const Block& block, unsigned mask);
  void store_carry(bool inverted = false);
  // Repeats the comparison of `d`, so that the host's flags equal the guest's.
  void compare_again(const Definition& d);

  // --- registers (emit_registers.cpp)
  static host::Gp gp(unsigned reg);  // 32 bits
  // Low part of the register as the host names it.
  static host::Gp low(unsigned reg, unsigned size);
  static host::Gp sized(const host::Gp& r, unsigned size);
  void get(const host::Gp& to, Part part);
  void put(Part part, const host::Gp& from);
  // The part's bits shifted to the top of 32, zeros below.
  void get_up(const host::Gp& to, Part part);
  void get_operand_up(const host::Gp& to, const Definition& d);
  // Rotates the register so that the part is low, and back.
  void turn(Part part);
  void turn_back(Part part);
  static bool high_byte(Part part) { return part.shift == 8 && part.reg < 4; }
  static host::Gp high(unsigned reg);

  // --- memory (emit_memory.cpp)
  host::Mem flag(std::size_t offset, unsigned size = 4) const;
  Place address(const Step& s, Mode mode, unsigned reg, unsigned size, std::uint32_t bytes,
                host::Mem& at);
  host::Mem ram_check(unsigned size, std::uint32_t bytes, const asmjit::Label& outside);
  // The place of step k's access through a register, if it is known to be in RAM or can be checked together
  // with later ones of the block.
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
  std::vector<asmjit::Label> inside_;   // entries after the check of the time left
  std::vector<asmjit::Label> outside_;  // entered through the table
  std::vector<asmjit::Label> late_;     // entered with less time left than the block's bound
  std::vector<std::function<void()>> side_, cold_;

  Pending pending_{};
  // What is known of a register within a block: from `low` to `high` beyond it all is RAM. Where a check
  // for several accesses fails, the block goes on in a second version of its code, which checks each.
  struct Proof {
    std::int32_t low = 0, high = 0;
    bool even = false;
  };
  std::array<Proof, 8> proofs_{};
  Again again_;            // steps of the second version that are reached from the first
  bool second_ = false;    // it is being emitted
  bool near_end_ = false;  // the time left is checked after each step

  asmjit::Label before_;
  bool has_before_ = false;
  unsigned native_ = 0;  // guest flags that are currently in the host's flags
  unsigned stored_ = 0;  // flags of the step's `keep` that are in memory already
};

}  // namespace kaz::h8s::translate
