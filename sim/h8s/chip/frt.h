// 16-bit free-running timer (FRT). The timer's state is computed only at accesses and events.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/chip/sticky.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class Frt {
 public:
  // Register accesses. `address` contains only the low 16 bits of the address: TIER..ICRD. `at` is the end of
  // the bus cycle.
  std::uint8_t read(Machine& m, std::uint32_t address, States at);
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  // Returns the value of the register at the time of the last advance().
  std::uint8_t peek(std::uint32_t address) const;

  // Returns the time of the next interrupt request or output change.
  States next_event(States epoch) const;
  // Must be called after the DTC has served the request of `vector`.
  void taken_by_dtc(Machine& m, unsigned vector, States at);
  // Advances count, flags and interrupt requests to the time `to`.
  void advance(Machine& m, States to);

  // Process an edge at the input capture pins FTIA..FTID (`n` 0..3) or at the clock input FTCI.
  void capture_edge(Machine& m, unsigned n, bool rising, States at);
  void clock_edge(Machine& m, States at);

  // Output 0 is FTOA, output 1 is FTOB.
  bool drives(unsigned output) const { return (tocr_ & (output ? TOCR::OEB : TOCR::OEA)) != 0; }
  bool level(unsigned output) const { return level_[output]; }
  // Returns the earliest time at which a match can change level(). Matches up to the last advance() are
  // ignored.
  States next_change(States epoch, unsigned output) const;
  bool waits_for_input() const {
    return (tier_ & kCaptures) != 0 || ((tcr_ & FRT_TCR::CKS) == FRT_TCR::CKS && (tier_ & kCounts));
  }

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(count_, tick_, flags_, tier_, tcr_, tocr_, temp_, clear_on_a_, use_af_, ocr_, icr_, ocrar_,
      ocraf_, ocrdm_, masked_, mask_end_, level_);
    a.require(tick_ >= 0, "timer");
  }

 private:
  // Bits of TIER. The flags in TCSR have the same positions.
  static constexpr std::uint8_t kCaptures = TIER::ICIAE | TIER::ICIBE | TIER::ICICE | TIER::ICIDE,
                                kCounts = TIER::OCIAE | TIER::OCIBE | TIER::OVIE;

  States divisor() const;  // clock divisor; 0: external clock
  // Returns the number of counts to the next match or overflow.
  std::int64_t to_next() const;
  std::int64_t to_count(std::uint32_t value) const;
  void step(Machine& m, std::int64_t counts, States at);
  bool captures_edge(unsigned n, bool rising) const;
  void match(Machine& m, unsigned n, States at);
  void update(Machine& m, States at);

  std::uint16_t count_ = 0;
  // Number of the clock tick at which the counter had the value `count_`. Ticks count from Machine::epoch.
  States tick_ = 0;
  StickyFlags flags_;
  std::uint8_t tier_ = TIER::ONE, tcr_ = 0, tocr_ = 0, temp_ = 0;
  bool clear_on_a_ = false;
  // Used while OCRAMS is set. At the next compare match A, the timer adds OCRAF (true) or OCRAR (false) to
  // OCRA.
  bool use_af_ = false;
  std::array<std::uint16_t, 2> ocr_{0xffff, 0xffff};
  std::array<std::uint16_t, 4> icr_{};
  std::uint16_t ocrar_ = 0xffff, ocraf_ = 0xffff, ocrdm_ = 0;
  // Used while ICRDMS is set. A capture by FTID makes `masked_` true. When FRC reaches ICRD + 2 * OCRDM,
  // `masked_` becomes false. FTID causes no other capture while `masked_` is true.
  bool masked_ = false;
  std::uint16_t mask_end_ = 0;
  std::array<bool, 2> level_{};
};

}  // namespace kaz::h8s
