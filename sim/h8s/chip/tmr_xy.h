// 8-bit timers TMRX and TMRY, and the registers of the timer connection.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/chip/timer8.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

// Source: hardware manual, 8-bit timers and timer connection. TMRX can count the undivided system clock,
// measures pulses at TMIX (P60) and drives TMOX (P67). TMRY has three interrupts and, on this part, no output
// pin. The signal paths of the timer connection are not modeled; enabling a signal path is reported as
// misuse.
class TmrXY {
 public:
  static constexpr unsigned kX = 0, kY = 1;

  // Register accesses: TCRX..TCORBX (banked by TCONRS.TMRX/Y) and TCONRI..SEDGR.
  std::uint8_t read(Machine& m, std::uint32_t address, States at);
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  std::uint8_t peek(std::uint32_t address) const;

  // Must be called after the DTC has served the request of TMRY's compare match A or B.
  void taken_by_dtc(Machine& m, unsigned vector, States at) {
    timer_[kY].flags.drop(vector & 1 ? TMR_TCSR::CMFB : TMR_TCSR::CMFA);
    update(m, at);
  }

  States next_event(const Machine& m) const;
  void advance(Machine& m, States to);
  // Processes an edge at TMIX or TMIY. Each of these pins is both the clock input and the reset input of a
  // timer.
  void pin_edge(Machine& m, unsigned n, bool rising, States at);

  // TMRX drives TMOX while any OS bit is set.
  bool drives() const { return timer_[kX].drives(); }
  bool level() const { return timer_[kX].level; }
  // Returns the earliest time at which a match can change level(). The function ignores matches that
  // advance() has already applied.
  States next_change(const Machine& m) const;
  bool waits_for_input() const;

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(timer_, ticrr_, ticrf_, tcorc_, tisr_, rose_, icie_, tconri_, tconro_, tconrs_, sedgr_);
  }

 private:
  States divisor(unsigned n) const;  // clock divisor; 0: the timer is stopped or clocked by a pin
  void advance_one(Machine& m, unsigned n, States to);
  void step(Machine& m, unsigned n, std::int64_t counts, States at);
  void update(Machine& m, States at);
  void capture(bool rising);
  bool bank_y() const { return (tconrs_ & TCONRS::TMRXY) != 0; }
  void write_timer(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  void write_connection(Machine& m, std::uint32_t address, std::uint8_t value);

  std::array<Timer8, 2> timer_;  // TCSRX.ICF is one of TMRX's flags
  std::uint8_t ticrr_ = 0, ticrf_ = 0, tcorc_ = 0xff, tisr_ = TISR::ONE;
  bool rose_ = false;  // the first half of a pulse measurement is done
  bool icie_ = false;  // TCSRY.ICIE
  std::uint8_t tconri_ = 0, tconro_ = 0, tconrs_ = 0, sedgr_ = 0;
};

}  // namespace kaz::h8s
