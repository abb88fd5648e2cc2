// Watchdog timers WDT0 and WDT1: interval timer or watchdog, with write keys.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/chip/sticky.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

// `n` is the number of the timer, 0 or 1.
class Wdt {
 public:
  // Register accesses. `counter` is true for TCNT (odd address) and false for TCSR (even address).
  std::uint8_t read(Machine& m, unsigned n, bool counter, States at);
  std::uint8_t peek(const Machine& m, unsigned n, bool counter, States at) const;
  // The upper byte is the key: 5A writes TCNT, A5 writes TCSR. Other keys are reported as misuse.
  void write_word(Machine& m, unsigned n, std::uint16_t value, States at);

  States next_event(const Machine& m, unsigned n) const;
  void advance(Machine& m, unsigned n, States to);
  bool running() const { return (tcsr_ & WTCSR::TME) != 0; }
  // Returns TCSR.PSS, which only WDT1 has.
  bool subclocked() const { return (tcsr_ & WTCSR::PSS) != 0; }
  bool watchdog() const { return (tcsr_ & WTCSR::WTIT) && (tcsr_ & WTCSR::TME); }

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(tcsr_, ovf_, count_, tick_);
    a.require(tick_ >= 0, "watchdog");
  }

 private:
  States divisor(const Machine& m, unsigned n) const;  // clock divisor; 0: no clock
  States base(const Machine& m, unsigned n) const;
  std::int64_t ticks(const Machine& m, unsigned n, States at) const;
  void update(Machine& m, unsigned n, States at);

  std::uint8_t tcsr_ = 0;  // TCSR without OVF
  StickyFlags ovf_;
  std::uint8_t count_ = 0;
  std::int64_t tick_ = 0;  // number of the clock tick at which the counter had the value count_
};

}  // namespace kaz::h8s
