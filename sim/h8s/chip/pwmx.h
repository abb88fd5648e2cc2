// 14-bit PWM timer with two channels. The pulse of a channel is distributed over base cycles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

// Source: hardware manual, 14-bit PWM timer. A conversion period lasts 16384 times T, where T is 1 or 2
// states (DACR.CKS).
class Pwmx {
 public:
  // Register accesses while STCR.IICE = 1: the bytes of DADRA and DADRB. REGS selects the bank.
  std::uint8_t peek(std::uint32_t address, States at) const;
  std::uint8_t read(std::uint32_t address, States at);
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  void reset() { *this = Pwmx{}; }

  // Channel 0 is PWX0 (A), channel 1 is PWX1 (B).
  bool enabled(unsigned channel) const { return (dacr_ & (channel ? DACR::OEB : DACR::OEA)) != 0; }
  // `data_is_low`: see Options::pwmx_data_is_low.
  bool level(unsigned channel, States at, bool data_is_low) const;
  // Returns the time of the next level change, or kNever if the level stays constant. The result is valid
  // until the next register write.
  States next_change(unsigned channel, States at, bool data_is_low) const;

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(dadr_, dacr_, temp_, base_, base_count_);
  }

 private:
  bool counting() const { return (dacr_ & DACR::PWME) != 0; }
  States period() const { return dacr_ & DACR::CKS ? 2 : 1; }  // T in states
  unsigned counter(States at) const;
  std::uint16_t packed_counter(States at) const;
  bool second_bank() const { return (dadr_[1] & DADR::REGS) != 0; }
  void set_control(std::uint8_t value, States at);

  std::array<std::uint16_t, 2> dadr_{0xffff, 0xffff - DADR::REGS};  // DADRA, DADRB
  std::uint8_t dacr_ = DACR::ONE, temp_ = 0;
  // The counter was `base_count_` at time `base_`.
  States base_ = 0;
  unsigned base_count_ = 0;
};

// Returns whether `count` (0..16383, within the conversion period) is inside a pulse. `data` (14 bits) is the
// total length of the pulses, in counts. A base cycle has 64 counts, or 256 with `long_cycle`. If `data` is
// less than one count per base cycle, there are no pulses.
bool pwmx_pulse(unsigned data, bool long_cycle, unsigned count);

}  // namespace kaz::h8s
