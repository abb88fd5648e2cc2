// Interfaces for observers of a running chip, and for a log of its inputs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "sim/h8s/chip/chip.h"

namespace kaz::h8s {

// Control flow of an instruction.
enum class Flow : std::uint8_t {
  plain,
  branch,  // Bcc but BRA and BRN
  jump,    // BRA, BRN, JMP
  call,    // BSR, JSR
  back,    // RTS
  trap,    // TRAPA
  exit,    // RTE
  sleep,   // SLEEP
};

// From the first word of the instruction.
Flow flow_of(std::uint16_t first_word);

// An instruction that has run.
struct Executed {
  std::uint32_t pc = 0;
  std::uint32_t next = 0;  // address of the next instruction executed
  std::uint16_t word = 0;  // its first word
  Flow flow = Flow::plain;
  std::uint8_t length = 2;  // bytes
  // False for all parts but the last of an interrupted EEPMOV.W, which is reported in parts.
  bool whole = true;
  States begin = 0, end = 0;
  bool taken() const { return next != pc + length; }
};

// One bus access: a byte, or a word at an even address. A long word is two words, as on the chip.
struct Access {
  std::uint32_t address = 0;
  std::uint32_t pc = 0;  // of the instruction; of the one that comes next for an exception entry
  std::uint16_t value = 0;
  std::uint8_t size = 1;  // bytes: 1 or 2
  bool write = false;
  States at = 0;
};

// An accepted interrupt. TRAPA is reported as an instruction.
struct ExceptionEntry {
  unsigned vector = 0;
  std::uint32_t interrupted = 0;  // the address stacked
  std::uint32_t handler = 0;
  States begin = 0, end = 0;
};

// Base class of observers. Calls are in order of time, accesses before the instruction that made them.
// An observer may read the chip (registers, peek) and call Chip::request_stop; it must not change or run
// the chip, nor attach or detach observers. Instruction fetches are not reported as accesses. Observation
// does not change the chip's behaviour or timing.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void before(std::uint32_t /*pc*/, States /*at*/) {}
  virtual void executed(const Executed&) {}
  virtual void accessed(const Access&) {}
  virtual void entered(const ExceptionEntry&) {}
  virtual void slept(States /*from*/, States /*to*/) {}
  // RES pin, watchdog or power-on.
  virtual void was_reset(ResetCause, States /*at*/) {}
  // Memory was changed from outside: poke, load, restore (`size` 0: all of it may differ).
  virtual void changed(std::uint32_t /*address*/, std::uint32_t /*size*/) {}
};

// Log of everything that enters the chip from outside, for replay. Implemented by History
// (debug/history.h), connected by Chip::set_input_log.
class InputLog {
 public:
  virtual ~InputLog() = default;
  // About to be applied at the boundary now(): pins, bytes received, reset, poke, set_registers.
  virtual void input(std::function<void(Chip&)> apply) = 0;
  // Something that cannot be played again: load, power_on, restore, or an input from inside a
  // listener, in the middle of an instruction.
  virtual void cut() = 0;
  // The analog source returned `value`.
  virtual void sampled(int channel, States at, double value) = 0;
};

}  // namespace kaz::h8s
