// The 14-bit PWM timer: two channels whose pulse is spread over base cycles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

// Hardware manual, 14-bit PWM timer. A conversion period is 16384 T (T = 1 or 2 states by DACR.CKS).
class Pwmx {
 public:
  // FFA0, FFA1, FFA6, FFA7 (with STCR.IICE = 1), banked by REGS.
  std::uint8_t peek(std::uint32_t address, States at) const;
  std::uint8_t read(std::uint32_t address, States at);
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  void reset() { *this = Pwmx{}; }

  // Channel 0 is PWX0 (A), 1 is PWX1 (B).
  bool enabled(unsigned channel) const { return (dacr_ >> (channel ? 3 : 2) & 1) != 0; }
  // `data_is_low`: DADR is the low time for OS = 0 (Options::pwmx_data_is_low).
  bool level(unsigned channel, States at, bool data_is_low) const;
  // Next state at which the level may change while no register is written; kNever: none.
  States next_change(unsigned channel, States at, bool data_is_low) const;

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(dadr_, dacr_, temp_, base_, base_count_);
  }

 private:
  bool counting() const { return (dacr_ & 0x40) != 0; }
  States period() const { return dacr_ & 1 ? 2 : 1; }  // T in states
  unsigned counter(States at) const;
  std::uint16_t packed_counter(States at) const;
  bool second_bank() const { return (dadr_[1] & 1) != 0; }
  void set_control(std::uint8_t value, States at);

  std::array<std::uint16_t, 2> dadr_{0xffff, 0xfffe};  // bit 0 of B is REGS
  std::uint8_t dacr_ = 0x30, temp_ = 0;
  // The counter was `base_count_` at time `base_`.
  States base_ = 0;
  unsigned base_count_ = 0;
};

// Whether count 0..16383 of the conversion period is in the pulse, whose length is the data value:
// 14-bit data, base cycles of 64 counts (long_cycle false) or 256. Below one count a base cycle
// there is no pulse at all.
bool pwmx_pulse(unsigned data, bool long_cycle, unsigned count);

}  // namespace kaz::h8s
