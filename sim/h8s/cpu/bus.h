// The CPU's interfaces to the layers above it: the bus of the chip, and a cache of translated code.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::h8s {

struct Cpu;

// What the chip provides to the CPU. Called on slow paths only: the inline accesses of access.h
// serve RAM and flash without it. A CPU without a bus (Flat) has RAM at every address.
class Bus {
 public:
  // Accesses outside the fast path: the short RAM window, I/O registers, flash that is being
  // programmed or erased, unmapped addresses; while the chip is observed, every access. Addresses are
  // masked to the mode's width, words are at even addresses. Adds wait states to Cpu::stall and
  // raises Fault::unmapped where there is nothing.
  virtual std::uint8_t load8(std::uint32_t address) = 0;
  virtual std::uint16_t load16(std::uint32_t address) = 0;
  virtual void store8(std::uint32_t address, std::uint8_t value) = 0;
  virtual void store16(std::uint32_t address, std::uint16_t value) = 0;
  // The same for registers (is_io in cpu.h), while the chip is not observed.
  virtual std::uint8_t load_io8(std::uint32_t address) = 0;
  virtual std::uint16_t load_io16(std::uint32_t address) = 0;
  virtual void store_io8(std::uint32_t address, std::uint8_t value) = 0;
  virtual void store_io16(std::uint32_t address, std::uint16_t value) = 0;
  // A word access at an odd address is about to be done at the even address below.
  virtual void odd_word_access(std::uint32_t address) = 0;

  // Whether an interrupt is requested that the mask bits I and UI of CCR let through.
  virtual bool interrupt_pending() const = 0;

  // Whether the instruction at this address must not run before its code hook has been called.
  virtual bool hook_due(std::uint32_t pc) const = 0;
  // Whether there is a code hook for this address at all, also while its instruction runs.
  virtual bool has_hook(std::uint32_t pc) const = 0;

  // Runs until now >= stop and notifies observers of each instruction. Cpu::observed selects it.
  virtual void run_observed() = 0;

 protected:
  ~Bus() = default;
};

// Host code translated from the guest's instructions, called once per stretch of execution.
class CodeCache {
 public:
  // Runs instructions until now >= stop.
  virtual void run(Cpu& c) = 0;
  // Discards code translated from `count` entries of Cpu::code from index `first` on.
  virtual void forget(std::uint32_t first, std::uint32_t count) = 0;
  virtual void forget_all() = 0;

 protected:
  ~CodeCache() = default;
};

}  // namespace kaz::h8s
