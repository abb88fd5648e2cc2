// The 16-bit free-running timer, brought up to date when it is accessed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/chip/sticky.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class Frt {
 public:
  // `address` is the low 16 bits: FF90..FF9F. `at` is when the bus cycle ends.
  std::uint8_t read(Machine& m, std::uint32_t address, States at);
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  // As of the last advance().
  std::uint8_t peek(std::uint32_t address) const;

  // Time of the next interrupt request or output change.
  States next_event(States epoch) const;
  // The DTC has served the request of `vector`.
  void taken_by_dtc(Machine& m, unsigned vector, States at);
  // Brings count, flags and requests up to `to`.
  void advance(Machine& m, States to);

  // Input capture pins FTIA..FTID (0..3) and the clock input FTCI.
  void capture_edge(Machine& m, unsigned n, bool rising, States at);
  void clock_edge(Machine& m, States at);

  bool drives(unsigned output) const { return (tocr_ & (output ? 4 : 8)) != 0; }
  bool level(unsigned output) const { return level_[output]; }
  // The next match that may change level(), from the last advance() on.
  States next_change(States epoch, unsigned output) const;
  bool waits_for_input() const {
    return (tier_ & 0xf0) != 0 || ((tcr_ & 3) == 3 && (tier_ & 0x0e));
  }

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(count_, tick_, flags_, tier_, tcr_, tocr_, temp_, clear_on_a_, use_af_, ocr_, icr_, ocrar_,
      ocraf_, ocrdm_, masked_, mask_end_, level_);
    a.require(tick_ >= 0, "timer");
  }

 private:
  States divisor() const;  // 0: external clock
  // Counts from now to the next match or overflow.
  std::int64_t to_next() const;
  std::int64_t to_count(std::uint32_t value) const;
  void step(Machine& m, std::int64_t counts, States at);
  bool captures_edge(unsigned n, bool rising) const;
  void match(Machine& m, unsigned n, States at);
  void update(Machine& m, States at);

  std::uint16_t count_ = 0;
  States tick_ = 0;  // clock ticks up to which count_ is right
  StickyFlags flags_;
  std::uint8_t tier_ = 1, tcr_ = 0, tocr_ = 0, temp_ = 0;
  bool clear_on_a_ = false;
  bool use_af_ = false;  // OCRAMS: OCRAF is added next, else OCRAR
  std::array<std::uint16_t, 2> ocr_{0xffff, 0xffff};
  std::array<std::uint16_t, 4> icr_{};
  std::uint16_t ocrar_ = 0xffff, ocraf_ = 0xffff, ocrdm_ = 0;
  // ICRDMS: after a capture D no other one until FRC reaches ICRD + 2 OCRDM.
  bool masked_ = false;
  std::uint16_t mask_end_ = 0;
  std::array<bool, 2> level_{};
};

}  // namespace kaz::h8s
