// State of the CPU, and format of a decoded instruction. All instruction handlers use these two structures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/cpu/bus.h"
#include "sim/h8s/cpu/types.h"

namespace kaz::h8s {

struct Cpu;
struct Insn;

// Runs one decoded instruction and returns the next instruction.
using Handler = const Insn* (*)(Cpu&, const Insn*);

// One decoded instruction. Cpu::code has an entry for each even address of memory. `run` is null until the
// instruction is decoded. Without a jump the next instruction is `this + units`.
struct Insn {
  Handler run;
  // Immediate operand, absolute address or displacement. For a near branch, `imm` is the distance from this
  // instruction to the target, in 16-bit units.
  std::uint32_t imm;
  std::uint8_t rs, rd;  // byte offsets into the register file, bit numbers or vector numbers
  std::uint8_t states;  // duration in states; Cpu::stall contains additional time
  std::uint8_t units;   // length in 16-bit units
};
static_assert(sizeof(void*) != 8 || sizeof(Insn) == 16);

// Error that ends a run.
enum class Fault : std::uint8_t { none, undefined, fetch, unmapped, stack, misuse, odd_pc };
constexpr Fault last_value(Fault) {
  return Fault::odd_pc;
}

// Address layout of the chip (hardware manual, memory map). RAM consists of two windows in the top 8 KiB
// block. The flat machine has only RAM, beginning at address 0. The CPU core therefore uses the layout
// members of Cpu instead of these constants.
inline constexpr std::uint32_t kFlashSize = 0x20000;
inline constexpr std::uint32_t kBlock = 0xffe000;  // address of the 8 KiB block that contains RAM
inline constexpr std::uint32_t kRam = 0x0080;  // kRam, kShortRam and kIo are offsets in this block
inline constexpr std::uint32_t kRamSize = 0x0f80;
inline constexpr std::uint32_t kShortRam = 0x1f00;
inline constexpr std::uint32_t kShortRamSize = 0x80;
inline constexpr std::uint32_t kIo = 0x1e50;  // I/O registers, before and after the short RAM
inline constexpr std::uint32_t kIoSize = 0x1b0;
// Layout of Cpu::code, in entries: flash, then the two RAM windows. Each region is followed by kGap entries
// that raise a fault.
inline constexpr std::uint32_t kGap = 8;
inline constexpr std::uint32_t kFlashCode = 0;
inline constexpr std::uint32_t kRamCode = kFlashSize / 2 + kGap;
inline constexpr std::uint32_t kShortRamCode = kRamCode + kRamSize / 2 + kGap;
inline constexpr std::uint32_t kCodeSize = kShortRamCode + kShortRamSize / 2 + kGap;
// Size of a line of RAM, bytes. Cpu::has_code has one flag for each line. The flag is set if Cpu::code may
// contain decoded instructions of the line.
inline constexpr std::uint32_t kLine = 64;
static_assert(kRam % kLine == 0 && kShortRam % kLine == 0);

// A recorded jump, for reports. The last kTrail jumps are kept. `from` is null if the origin of the jump is
// unknown.
struct Jump {
  const Insn* from;
  const Insn* to;
};
inline constexpr std::uint32_t kTrail = 32;

// Condition codes, evaluated lazily: each member is the value from which a flag is computed. ccr() packs the
// flags into a byte. Operands of 8 and 16 bits are shifted to the top of 32 bits. Therefore each flag has the
// same bit position for all three operand sizes.
struct Flags {
  std::uint32_t n = 0;  // flag N is bit 31 of `n`
  std::uint32_t z = 1;  // flag Z is set if `z` is 0
  std::uint32_t v = 0;  // flag V is bit 31 of `v`
  std::uint32_t h = 0;  // flag H is bit 28 of `h` (flags.h)
  std::uint32_t c = 0;  // flag C itself: 0 or 1
  template <class A>
  void transfer(A& a) {
    a(n, z, v, h, c);
    a.require(c <= 1, "carry");
  }
};

struct Cpu {
  // Members of the inner loop.
  std::array<std::uint32_t, 8> er{};
  Flags flags;
  const Insn* ip = nullptr;  // the running instruction; between instructions, the next instruction
  States now = 0;            // end time of the running instruction, without `stall`
  // The inner loop ends at the first instruction boundary with now >= stop.
  States stop = 0;
  // Time that I/O accesses and block moves have added since the inner loop was entered, in states. `now` does
  // not include this time.
  States stall = 0;
  std::int64_t executed = 0;  // instructions

  std::uint8_t* flash = nullptr;
  // Pointer to the memory at address ram_at. The short RAM window is at a higher offset from this pointer.
  std::uint8_t* ram = nullptr;
  std::uint8_t* has_code = nullptr;   // flag for each line (kLine) of RAM; line 0 begins at ram_at
  Insn* code = nullptr;               // decoded instructions
  std::uint32_t ram_size = kRamSize;  // 0 while SYSCR.RAME = 0
  std::uint32_t flash_size = kFlashSize;
  std::uint32_t mask = 0xffffff;  // address mask: 0xffff in normal mode
  // Start of RAM and end of flash for the fast paths of access.h. While the chip is observed, no address is
  // in these ranges, so that every access takes the slow path (Machine::choose_paths).
  std::uint32_t ram_base = kBlock + kRam;
  std::uint32_t quick_flash = kFlashSize;
  bool observed = false;
  std::uint32_t ram_at = kBlock + kRam;  // address of RAM, valid even while the chip is observed
  std::uint32_t ram_code = kRamCode;     // index of the first RAM entry in `code`
  // Index of the first entry of short RAM in `code`. The flat machine has no short RAM. On the flat machine,
  // this index is code_size.
  std::uint32_t short_ram_code = kShortRamCode;
  std::uint32_t code_size = kCodeSize;     // number of entries in `code`
  Bus* bus = nullptr;                      // null: there is RAM at every address (Flat)
  const std::uint64_t* pending = nullptr;  // two words of interrupt requests; null if `bus` is null
  bool hooks = false;                      // whether any code hook is set
  Engine engine = Engine::interpreter;
  CodeCache* translated = nullptr;       // null: instructions are interpreted
  std::uint32_t translate_after = 1000;  // Options::translate_after

  std::uint8_t control = 0x80;  // bits I, UI, U of CCR
  std::uint8_t exr = 0x7f;
  bool flat = false;         // flat machine: 16 MiB of RAM, addresses wrap, an odd PC is an error
  bool semihost = false;     // JSR @@0xC5:8 to @@0xCC:8 are semihosting requests
  std::uint8_t request = 0;  // number of the semihosting request to handle; 0: no request
  bool normal = false;       // normal mode: 16-bit addresses
  bool two_level = false;    // interrupt control mode 1: exceptions also set UI
  bool stc_copies = false;   // struct Options describes this member and the next two members
  bool rte_holds_off = false;
  bool predecrement_stores_decremented = true;
  bool hold_off = false;  // no interrupt is accepted before the next instruction
  bool asleep = false;
  bool moving = false;          // an EEPMOV.W was interrupted between two bytes
  bool code_discarded = false;  // the code cache was cleared while translated code was running
  // True if has_code may have flags set. If false, store instructions in translated code do not check
  // has_code.
  bool code_in_ram = false;
  Fault fault = Fault::none;
  std::uint32_t fault_address = 0;
  std::uint32_t fault_pc = 0;
  // at_address() returns this entry for an address without memory; `imm` is the address.
  Insn outside{};

  // Storage of has_code on the chip.
  std::array<std::uint8_t, 0x2000 / kLine> chip_lines{};

  std::array<Jump, kTrail> trail{};
  std::uint32_t jumps = 0;
};

// Ends the inner loop at the next boundary. Sets `stop` to -1, which is less than any time value. `stop` is
// not set to the lowest integer, because the difference `stop - now` would then overflow.
inline void end_stretch(Cpu& c) {
  c.stop = -1;
}

// Returns whether `address` is in the register area of the chip: FE50..FEFF or FF80..FFFF.
inline bool is_io(const Cpu& c, std::uint32_t address) {
  const std::uint32_t offset = (address & c.mask) - (c.mask & (kBlock + kIo));
  return offset < kIoSize && offset - (kShortRam - kIo) >= kShortRamSize;
}

// Adds wait states to `stall`. While the inner loop runs, `now` does not include wait states. Therefore the
// function subtracts the wait states from `stop`, so that the inner loop ends at the right time.
inline void add_stall(Cpu& c, int states) {
  c.stall += states;
  if (c.stop > 0) c.stop -= states;
}

// Must be called by an instruction that writes CCR or EXR. Ends the inner loop if a request is pending or the
// time has reached `stop`. `hold_off`: no interrupt is accepted before the next instruction.
void mask_changed(Cpu& c, bool hold_off);

// Returns CCR, packed from the mask bits and the flags.
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

// Returns the address of a decoded instruction.
inline std::uint32_t pc_of(const Cpu& c, const Insn* ip) {
  if (ip == &c.outside) return ip->imm;
  const auto index = static_cast<std::uint32_t>(ip - c.code);
  if (index < c.ram_code) return index * 2;
  if (index < c.short_ram_code) return c.ram_at + (index - c.ram_code) * 2;
  return (c.mask & (kBlock + kShortRam)) + (index - kShortRamCode) * 2;
}

// Returns the entry of Cpu::code for an address, or `outside` if the address has no memory. On the chip, the
// function ignores bit 0 of the address. On the flat machine, the function returns `outside` for an odd
// address. If the flat machine executes the entry Cpu::outside of an odd address, the CPU raises
// Fault::odd_pc.
const Insn* at_address(Cpu& c, std::uint32_t address);

inline const Insn* record_jump(Cpu& c, const Insn* from, const Insn* to) {
  c.trail[c.jumps++ % kTrail] = {from, to};
  return to;
}

// Returns the instruction at `address` and records the jump.
inline const Insn* jump_to(Cpu& c, const Insn* from, std::uint32_t address) {
  const std::uint32_t even = address & c.mask & ~1u;
  return record_jump(c, from,
                     even < c.flash_size ? c.code + kFlashCode + even / 2 : at_address(c, address));
}

// Decodes the instruction at `ip` into Cpu::code and returns its handler.
Handler decode_in_place(Cpu& c, const Insn* ip);

// Must be called before a flag of has_code is set. The first call discards all code that was translated
// before the call, because the stores in that code do not check has_code.
void note_code_in_ram(Cpu& c);

// Like decode_in_place(), but does not use the special handlers for near branches (see Insn::imm). Used by
// the reference engine.
Handler decode_afresh(Cpu& c, const Insn* ip);

// Each of these functions runs instructions until the time `now` has reached the time `stop`. The
// instructions that one call runs are called a "stretch". The members of `c` determine the engine that
// run_stretch() uses.
void run_stretch(Cpu& c);
void run_reference(Cpu& c);
void run_interpreter(Cpu& c);

// These functions return the results of Bus::hook_due and Bus::has_hook, or false if there is no bus.
bool hooked_here(const Cpu& c, std::uint32_t pc);
bool has_hook(const Cpu& c, std::uint32_t pc);

// Enters an exception (TRAPA or interrupt): stacks PC and CCR, sets the mask bits and returns the first
// instruction of the handler. The function itself adds no time.
const Insn* enter_exception(Cpu& c, const Insn* from, std::uint32_t return_pc, unsigned vector);

// Records the first fault with its address and PC, and ends the inner loop.
void raise_fault(Cpu& c, Fault fault, std::uint32_t address);

}  // namespace kaz::h8s
