// Interfaces through which the CPU calls the chip's bus and the cache of translated code.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::h8s {

struct Cpu;

// Interface to memory, interrupts and code hooks of the chip. The CPU calls the bus on slow paths only,
// because the inline accesses of access.h serve RAM and flash. A CPU without a bus (Flat) has RAM at every
// address.
class Bus {
 public:
  // The CPU calls these functions for accesses to the short RAM window, I/O registers and unmapped addresses.
  // The CPU also calls these functions for writes to flash, and for reads of flash while flash is programmed,
  // erased or verified. While the chip is observed, the CPU calls these functions for every access. Addresses
  // must be masked to the address width of the CPU mode, and must be even for words. These functions add wait
  // states to Cpu::stall and raise Fault::unmapped at an unmapped address.
  virtual std::uint8_t load8(std::uint32_t address) = 0;
  virtual std::uint16_t load16(std::uint32_t address) = 0;
  virtual void store8(std::uint32_t address, std::uint8_t value) = 0;
  virtual void store16(std::uint32_t address, std::uint16_t value) = 0;
  // Accesses to I/O registers (is_io in cpu.h). These functions do not notify observers.
  virtual std::uint8_t load_io8(std::uint32_t address) = 0;
  virtual std::uint16_t load_io16(std::uint32_t address) = 0;
  virtual void store_io8(std::uint32_t address, std::uint8_t value) = 0;
  virtual void store_io16(std::uint32_t address, std::uint16_t value) = 0;
  // Reports a word access at the odd `address`. The CPU then accesses the word at the even address, `address`
  // minus 1.
  virtual void odd_word_access(std::uint32_t address) = 0;

  // Interrupt control mode 0: returns whether any requested interrupt is not masked by CCR. Interrupt control
  // mode 1: returns whether any interrupt is requested, masked or not.
  virtual bool interrupt_pending() const = 0;

  // Returns whether `pc` has a code hook that must be called before the instruction at `pc` runs.
  virtual bool hook_due(std::uint32_t pc) const = 0;
  // Returns whether `pc` has a code hook. Unlike hook_due(), this function ignores whether the hook has
  // already been called.
  virtual bool has_hook(std::uint32_t pc) const = 0;

  // Runs until now >= stop and notifies observers of each instruction. Used while Cpu::observed is set.
  virtual void run_observed() = 0;

 protected:
  ~Bus() = default;
};

// Cache of host code translated from guest instructions.
class CodeCache {
 public:
  // Runs instructions until now >= stop.
  virtual void run(Cpu& c) = 0;
  // Discards code translated from `count` entries of Cpu::code, beginning at index `first`.
  virtual void forget(std::uint32_t first, std::uint32_t count) = 0;
  virtual void forget_all() = 0;

 protected:
  ~CodeCache() = default;
};

}  // namespace kaz::h8s
