// Interfaces for observers of a running chip and for a log of the chip's inputs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "sim/h8s/chip/chip.h"

namespace kaz::h8s {

// Control flow of an instruction.
enum class Flow : std::uint8_t {
  plain,
  branch,  // Bcc except BRA and BRN
  jump,    // BRA, BRN, JMP
  call,    // BSR, JSR
  back,    // RTS
  trap,    // TRAPA
  exit,    // RTE
  sleep,   // SLEEP
};

// Returns the control flow of the instruction that begins with the word `first_word`.
Flow flow_of(std::uint16_t first_word);

// An instruction that has run.
struct Executed {
  std::uint32_t pc = 0;
  std::uint32_t next = 0;  // address of the instruction that runs next
  std::uint16_t word = 0;  // first word of the instruction
  Flow flow = Flow::plain;
  std::uint8_t length = 2;  // bytes
  // An interrupted EEPMOV.W is reported in several parts. `whole` is false for all parts except the last.
  bool whole = true;
  States begin = 0, end = 0;
  bool taken() const { return next != pc + length; }
};

// One bus access to data: a byte, or a word at an even address. An access to a long word is reported as two
// accesses, as on the chip's bus.
struct Access {
  std::uint32_t address = 0;
  // Address of the instruction. For an access by an exception entry or the DTC: address of the next
  // instruction.
  std::uint32_t pc = 0;
  std::uint16_t value = 0;
  std::uint8_t size = 1;  // size in bytes: 1 or 2
  bool write = false;
  States at = 0;
};

// Entry into an accepted interrupt. TRAPA is reported as an instruction.
struct ExceptionEntry {
  unsigned vector = 0;
  std::uint32_t interrupted = 0;  // stacked return address
  std::uint32_t handler = 0;
  States begin = 0, end = 0;
};

// Base class of observers. Calls are in order of time. The accesses of an instruction are reported before the
// instruction. Instruction fetches are not reported as accesses. An observer may read the chip (registers,
// peek) and call Chip::request_stop. An observer must not change or run the chip, and must not attach or
// detach observers. Observation does not change the behavior or timing of the chip.
class Observer {
 public:
  virtual ~Observer() = default;
  // Called before the instruction at `pc` runs.
  virtual void before(std::uint32_t /*pc*/, States /*at*/) {}
  virtual void executed(const Executed&) {}
  virtual void accessed(const Access&) {}
  virtual void entered(const ExceptionEntry&) {}
  virtual void slept(States /*from*/, States /*to*/) {}
  // Called after a reset. `at` is the time of the first instruction after the reset.
  virtual void was_reset(ResetCause, States /*at*/) {}
  // Called after poke, load or restore has changed memory. If `size` is 0, all memory may have changed.
  virtual void changed(std::uint32_t /*address*/, std::uint32_t /*size*/) {}
};

// Log of all inputs of the chip, for replay. History (debug/history.h) implements this interface.
// Chip::set_input_log connects a log to a chip.
class InputLog {
 public:
  virtual ~InputLog() = default;
  // Called before an input is applied. The input is applied at now(), between two instructions. Inputs are
  // levels of pins and mode pins, received bytes, reset, poke and set_registers. `apply` repeats the input on
  // another chip.
  virtual void input(std::function<void(Chip&)> apply) = 0;
  // Called if the chip gets an input that cannot be replayed. Such inputs are calls of load(), power_on(),
  // restore(), read_state() and call(), and all inputs from listeners. Inputs from listeners cannot be
  // replayed, because listeners may be called in the middle of an instruction.
  virtual void cut() = 0;
  // Called after the analog source has returned `value`.
  virtual void sampled(int channel, States at, double value) = 0;
};

}  // namespace kaz::h8s
