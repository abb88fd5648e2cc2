// The boot ROM: loads a program into RAM over a serial channel (hardware manual, boot mode).
// SPDX-License-Identifier: Apache-2.0
//
// Its instructions are not known; it is modelled as a sequence of steps with their times. Its bytes pass
// through the serial channel bit by bit, as those of any program. The CPU is stopped until the loaded
// program starts.
#pragma once

#include <cstdint>

#include "sim/h8s/chip/chip.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class BootRom {
 public:
  // Boot mode is selected by the mode pins at a reset.
  void enter(Machine& m, States at);
  // Reset or power cut at `at`: an erase pulse ends in the middle.
  void leave(Machine& m, States at);
  bool active() const { return step_ != Step::off; }
  bool measuring() const { return step_ == Step::measure; }

  States next_event() const { return wake_; }
  void advance(Machine& m, States to);

  // During the bit rate measurement: a whole byte whose last stop bit ended at `byte.at`, or an edge.
  void heard(Machine& m, const ReceivedByte& byte);
  void edge(Machine& m, bool level, States at);

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(step_, wake_, low_since_, sending_, answers_, expected_, stored_, block_, pulse_from_);
    a.require(is_possible(), "boot mode");
  }

 private:
  enum class Step : std::uint8_t {
    off,
    measure,     // bit time of the host's H'00
    greet,       // sends H'00
    match,       // waits for H'55
    count_high,  // of bytes
    count_low,
    load,   // receives the program
    check,  // whether the flash is blank
    erase,  // an erase pulse is running
    answer,
    halted,
  };
  friend constexpr Step last_value(Step) { return Step::halted; }
  bool is_possible() const;  // indices fit their step
  void measured(Machine& m, States low, States at);
  void poll(Machine& m, States at);
  void take(Machine& m, std::uint8_t byte, States at);
  void next_block(Machine& m, States at);
  void finish(Machine& m, States at);
  void halt(std::uint8_t answer);
  void start_program(Machine& m, States at);

  Step step_ = Step::off;
  States wake_ = kNever;
  States low_since_ = kNever;  // RxD
  std::int32_t sending_ = -1;  // byte waiting for the transmitter
  std::int32_t answers_ = 0;   // H'AA still to be sent before the program starts
  std::uint32_t expected_ = 0, stored_ = 0;
  std::uint32_t block_ = 0;
  States pulse_from_ = kNever;
};

}  // namespace kaz::h8s
