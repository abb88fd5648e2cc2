// The CPU's state and the decoded instruction: what every instruction handler works on.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/cpu/bus.h"
#include "sim/h8s/cpu/types.h"

namespace kaz::h8s {

struct Cpu;
struct Insn;

// Runs one instruction and returns the next one.
using Handler = const Insn* (*)(Cpu&, const Insn*);

// One decoded instruction; there is one for each even address of memory. `run` is null until it is
// decoded. Sequential flow is pointer arithmetic: the next instruction is `this + units`.
struct Insn {
  Handler run;
  std::uint32_t imm;    // immediate, absolute address or displacement; branches: units to add
  std::uint8_t rs, rd;  // byte offsets into the register file, bit numbers or vector numbers
  std::uint8_t states;  // with all accesses to on-chip memory; I/O adds to Cpu::stall
  std::uint8_t units;   // length in 16-bit units
};
static_assert(sizeof(void*) != 8 || sizeof(Insn) == 16);

enum class Fault : std::uint8_t { none, undefined, fetch, unmapped, stack, misuse, odd_pc };
constexpr Fault last_value(Fault) {
  return Fault::odd_pc;
}

// The chip's address layout (hardware manual, memory map). RAM consists of two windows in the top 8 KiB
// block. The flat machine has one window of RAM from 0 and nothing else; the CPU uses the members of Cpu.
inline constexpr std::uint32_t kFlashSize = 0x20000;
inline constexpr std::uint32_t kBlock = 0xffe000;  // address of the block
inline constexpr std::uint32_t kRam = 0x0080;      // offsets into the block
inline constexpr std::uint32_t kRamSize = 0x0f80;
inline constexpr std::uint32_t kShortRam = 0x1f00;
inline constexpr std::uint32_t kShortRamSize = 0x80;
inline constexpr std::uint32_t kIo = 0x1e50;  // registers, and behind the short RAM again
inline constexpr std::uint32_t kIoSize = 0x1b0;
// Decoded instructions: flash, then the two RAM windows, each followed by a gap of entries that fault.
inline constexpr std::uint32_t kGap = 8;
inline constexpr std::uint32_t kFlashCode = 0;
inline constexpr std::uint32_t kRamCode = kFlashSize / 2 + kGap;
inline constexpr std::uint32_t kShortRamCode = kRamCode + kRamSize / 2 + kGap;
inline constexpr std::uint32_t kCodeSize = kShortRamCode + kShortRamSize / 2 + kGap;
// One flag per line of RAM: whether instructions there may have been decoded. Bytes.
inline constexpr std::uint32_t kLine = 64;
static_assert(kRam % kLine == 0 && kShortRam % kLine == 0);

struct Jump {
  const Insn* from;
  const Insn* to;
};
inline constexpr std::uint32_t kTrail = 32;

// Flags are evaluated lazily: kept as the values that they are computed from, packed by ccr(). Operands of
// 8 and 16 bits are shifted to the top of 32, so the same bit positions serve all three sizes.
struct Flags {
  std::uint32_t n = 0;  // N is bit 31
  std::uint32_t z = 1;  // Z is set when this is 0
  std::uint32_t v = 0;  // V is bit 31
  std::uint32_t h = 0;  // H is bit 28: carry out of bit 3, 11 or 27
  std::uint32_t c = 0;  // 0 or 1
  template <class A>
  void transfer(A& a) {
    a(n, z, v, h, c);
    a.require(c <= 1, "carry");
  }
};

struct Cpu {
  // Used by the inner loop.
  std::array<std::uint32_t, 8> er{};
  Flags flags;
  const Insn* ip = nullptr;  // the current instruction, or the next one between instructions
  States now = 0;            // end of that instruction, without `stall`
  States stop = 0;           // the inner loop ends at the first boundary where now >= stop
  States stall =
      0;  // additional states since the inner loop was entered: I/O accesses, block moves
  std::int64_t executed = 0;

  std::uint8_t* flash = nullptr;
  std::uint8_t* ram = nullptr;       // contents at ram_at; the short window is at a higher offset
  std::uint8_t* has_code = nullptr;  // a flag for each line of RAM, from ram_at on
  Insn* code = nullptr;
  std::uint32_t ram_size = kRamSize;  // 0 while SYSCR.RAME = 0
  std::uint32_t flash_size = kFlashSize;
  std::uint32_t mask = 0xffffff;  // of addresses: 0xffff in normal mode
  // Address ranges of the fast paths of access.h. While the chip is observed they are empty, so every
  // access takes the slow path (Machine::choose_paths).
  std::uint32_t ram_base = kBlock + kRam;
  std::uint32_t quick_flash = kFlashSize;
  bool observed = false;
  std::uint32_t ram_at = kBlock + kRam;          // address of RAM, independent of ram_base
  std::uint32_t ram_code = kRamCode;             // index of RAM in `code`
  std::uint32_t short_ram_code = kShortRamCode;  // index of the short window; flat: past the end
  std::uint32_t code_size = kCodeSize;           // of `code`
  Bus* bus = nullptr;                            // null: RAM at every address (Flat)
  const std::uint64_t* pending = nullptr;  // requests to the CPU, two words of bits; with `bus`
  bool hooks = false;                      // any code hooks set
  Engine engine = Engine::interpreter;
  CodeCache* translated = nullptr;  // null: interpret
  std::uint32_t translate_after = 1000;

  std::uint8_t control = 0x80;  // bits I, UI, U of CCR
  std::uint8_t exr = 0x7f;
  bool flat = false;         // 16 MiB of RAM: addresses wrap, an odd PC is an error
  bool semihost = false;     // JSR @@0xC5:8 to @@0xCC:8 are semihosting requests
  std::uint8_t request = 0;  // vector of the request just made
  bool normal = false;       // 16-bit mode
  bool two_level = false;    // interrupt control mode 1: exceptions set UI too
  bool stc_copies = false;   // Options
  bool rte_holds_off = false;
  bool predecrement_stores_decremented = true;
  bool hold_off = false;  // interrupts are held off for one instruction
  bool asleep = false;
  bool moving = false;          // EEPMOV.W interrupted between two bytes
  bool code_discarded = false;  // translated code has been discarded while it ran
  bool code_in_ram = false;     // any flag of has_code; until then translated stores do not look
  Fault fault = Fault::none;
  std::uint32_t fault_address = 0;
  std::uint32_t fault_pc = 0;
  Insn outside{};  // any address without memory; imm is the address

  // On the chip, the target of has_code.
  std::array<std::uint8_t, 0x2000 / kLine> chip_lines{};

  std::array<Jump, kTrail> trail{};
  std::uint32_t jumps = 0;
};

// Ends the inner loop at the next boundary: a time before every other, whose distance to them does not
// overflow.
inline void end_stretch(Cpu& c) {
  c.stop = -1;
}

// Whether the chip has a register there, or could have one: FE50..FEFF and FF80..FFFF.
inline bool is_io(const Cpu& c, std::uint32_t address) {
  const std::uint32_t offset = (address & c.mask) - (c.mask & (kBlock + kIo));
  return offset < kIoSize && offset - (kShortRam - kIo) >= kShortRamSize;
}

// Adds states that `now` does not include until the inner loop ends; `stop` is reduced instead.
inline void add_stall(Cpu& c, int states) {
  c.stall += states;
  if (c.stop > 0) c.stop -= states;
}

// After a change of the interrupt mask or an instruction that holds interrupts off: leaves the inner loop
// if a request is pending.
void mask_changed(Cpu& c, bool hold_off);

inline std::uint8_t ccr(const Cpu& c) {
  const Flags& f = c.flags;
  return static_cast<std::uint8_t>(c.control | (f.h >> 28 & 1) << 5 | (f.n >> 31) << 3 |
                                   (f.z == 0 ? 4u : 0u) | (f.v >> 31) << 1 | f.c);
}

inline void set_ccr(Cpu& c, std::uint32_t value) {
  c.control = static_cast<std::uint8_t>(value & 0xd0);
  c.flags.h = (value >> 5 & 1) << 28;
  c.flags.n = value >> 3 << 31;
  c.flags.z = (value >> 2 & 1) ^ 1;
  c.flags.v = value >> 1 << 31;
  c.flags.c = value & 1;
}

// Address of a decoded instruction.
inline std::uint32_t pc_of(const Cpu& c, const Insn* ip) {
  if (ip == &c.outside) return ip->imm;
  const auto index = static_cast<std::uint32_t>(ip - c.code);
  if (index < c.ram_code) return index * 2;
  if (index < c.short_ram_code) return c.ram_at + (index - c.ram_code) * 2;
  return (c.mask & (kBlock + kShortRam)) + (index - kShortRamCode) * 2;
}

// The decoded instruction of an address, `outside` where there is no memory. Bit 0 is ignored.
const Insn* at_address(Cpu& c, std::uint32_t address);

inline const Insn* record_jump(Cpu& c, const Insn* from, const Insn* to) {
  c.trail[c.jumps++ % kTrail] = {from, to};
  return to;
}

inline const Insn* jump_to(Cpu& c, const Insn* from, std::uint32_t address) {
  const std::uint32_t even = address & c.mask & ~1u;
  return record_jump(c, from,
                     even < c.flash_size ? c.code + kFlashCode + even / 2 : at_address(c, address));
}

// Decodes the instruction at `ip` into Cpu::code and returns its handler.
Handler decode_in_place(Cpu& c, const Insn* ip);

// Before the first flag of has_code is set.
void note_code_in_ram(Cpu& c);

// For the reference engine: decodes from memory each time, with branches in their general form.
Handler decode_afresh(Cpu& c, const Insn* ip);

// Runs instructions with the engine of `c` until now >= stop (run.cpp).
void run_stretch(Cpu& c);
void run_reference(Cpu& c);
void run_interpreter(Cpu& c);

// Whether the code hook of this address is due, before its instruction may run.
bool hooked_here(const Cpu& c, std::uint32_t pc);
// Whether there is a code hook for this address at all, also while its instruction runs.
bool has_hook(const Cpu& c, std::uint32_t pc);

// Exception entry, shared by TRAPA and interrupts: stacks PC and CCR, sets the mask bits and returns
// the handler's first instruction. Adds no time.
const Insn* enter_exception(Cpu& c, const Insn* from, std::uint32_t return_pc, unsigned vector);

void raise_fault(Cpu& c, Fault fault, std::uint32_t address);

}  // namespace kaz::h8s
