// Boot ROM: loads a program into RAM over a serial channel (hardware manual, boot mode).
// SPDX-License-Identifier: Apache-2.0
//
// The instructions of the boot ROM are not known. Therefore this class models the steps of the ROM and the
// time of each step. The bytes that the ROM sends and receives pass through the serial channel bit by bit,
// like the bytes of a program. The CPU is stopped until the loaded program starts.
#pragma once

#include <cstdint>

#include "sim/h8s/chip/chip.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class BootRom {
 public:
  // Must be called at a reset with mode pins that select boot mode.
  void enter(Machine& m, States at);
  // Must be called at a reset or power cut. If an erase pulse is running, the pulse has a partial effect.
  void leave(Machine& m, States at);
  bool active() const { return step_ != Step::off; }
  bool measuring() const { return step_ == Step::measure; }

  States next_event() const { return wake_; }
  void advance(Machine& m, States to);

  // heard() and edge() pass the host's signal to the measurement of the bit rate. The function heard() gets a
  // whole byte, and the function edge() gets an edge at RxD. If the bit_states of a byte is 0, heard()
  // ignores the byte.
  void heard(Machine& m, const ReceivedByte& byte);
  void edge(Machine& m, bool level, States at);

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(step_, wake_, low_since_, sending_, answers_, expected_, stored_, block_, pulse_from_);
    a.require(is_possible(), "boot mode");
  }

 private:
  enum class Step : std::uint8_t {
    off,
    measure,     // measures the bit time of the host's byte H'00
    greet,       // sends H'00
    match,       // waits for H'55
    count_high,  // receives the size of the program
    count_low,
    load,    // receives the program
    check,   // waits until the last echo is sent
    erase,   // checks the blocks and erases each block that is not blank
    answer,  // sends H'AA, then starts the program
    halted,  // sends H'FF and stops
  };
  friend constexpr Step last_value(Step) { return Step::halted; }
  bool is_possible() const;  // returns whether all restored members are in their ranges
  void measured(Machine& m, States low, States at);
  void poll(Machine& m, States at);
  void take(Machine& m, std::uint8_t byte, States at);
  void next_block(Machine& m, States at);
  void finish(Machine& m, States at);
  void halt(std::uint8_t answer);
  void start_program(Machine& m, States at);

  Step step_ = Step::off;
  States wake_ = kNever;
  States low_since_ = kNever;  // time of the falling edge at RxD
  std::int32_t sending_ = -1;  // byte waiting for the transmitter; -1: no byte
  std::int32_t answers_ = 0;   // number of H'AA bytes to send before the program starts
  // Size of the program in bytes, and number of program bytes already in RAM.
  std::uint32_t expected_ = 0, stored_ = 0;
  std::uint32_t block_ = 0;     // flash block that is checked or erased
  States pulse_from_ = kNever;  // start time of the erase pulse
};

}  // namespace kaz::h8s
