// 8-bit timers TMR0 and TMR1, alone or cascaded. Computes the state only at accesses and events.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/chip/timer8.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class Tmr {
 public:
  // Register accesses, TCR0..TCNT1: even addresses for TMR0, odd addresses for TMR1.
  std::uint8_t read(Machine& m, std::uint32_t address, States at);
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  std::uint8_t peek(std::uint32_t address) const;

  States next_event(Machine& m) const;
  void advance(Machine& m, States to);
  // Must be called after the DTC has served the request of compare match A or B.
  void taken_by_dtc(Machine& m, unsigned vector, States at);
  // Must be called after STCR has selected another prescaler.
  void clock_changed(Machine& m, States at);
  // Process an edge at the clock input TMCI0/1 or at the reset input TMRI0/1.
  void clock_edge(Machine& m, unsigned n, bool rising, States at);
  void reset_edge(Machine& m, unsigned n, bool rising, States at);

  // A timer drives its pin TMO0 or TMO1 while any OS bit is set.
  bool drives(unsigned n) const { return timer_[n].drives(); }
  bool level(unsigned n) const { return timer_[n].level; }
  // Returns the earliest time at which a match can change level(). The function ignores matches that
  // advance() has already applied.
  States next_change(const Machine& m, unsigned n) const;
  // Returns the duty cycle 0..1 of the steady waveform.
  double high_share(Machine& m, unsigned n) const;
  bool waits_for_input() const;

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(timer_);
  }

 private:
  States divisor(const Machine& m, unsigned n) const;  // clock divisor; 0: stopped or external
  bool cascaded(unsigned n) const { return timer_[n].clock_select() == 4; }
  void step(Machine& m, unsigned n, std::int64_t counts, States at);
  void step_pair(Machine& m, std::int64_t counts, States at);
  // Called at compare match A of TMR0. Triggers the A/D converter and clocks TMR1, if they are set up for it.
  void matched_a0(Machine& m, States at);
  void advance_one(Machine& m, unsigned n, States to);
  void update(Machine& m, unsigned n, States at);

  std::array<Timer8, 2> timer_;
};

}  // namespace kaz::h8s
