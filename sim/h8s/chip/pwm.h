// 8-bit PWM timer: sixteen channels on one counter, with pulse division.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class Pwm {
 public:
  // Register accesses: PWOERB..PWDR and PCSR.
  std::uint8_t peek(std::uint32_t address) const;
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  // If the write would change no waveform, the function writes the register and returns true. Otherwise the
  // function writes nothing and returns false. If the result is false, the caller must call write().
  bool write_quietly(std::uint32_t address, std::uint8_t value) {
    if (address == io::PWDR) return data_[select_ & PWSL::RS] == value;
    if (address != io::PWSL || ((value ^ select_) & (PWSL::PWCKE | PWSL::PWCKS)) != 0) return false;
    select_ = (value & ~PWSL::ZERO) | PWSL::ONE;
    return true;
  }
  // Prescaler and counter start at the time `epoch`, at which the chip was reset.
  explicit Pwm(States epoch = 0) : epoch_(epoch), base_(epoch) {}
  // Clears all registers, including PCSR. Module stop and standby also clear these registers.
  void reset() { *this = Pwm(epoch_); }

  bool enabled(unsigned channel) const { return (oe_ >> channel & 1) != 0; }
  // Returns the duty cycle as the number of high counts out of 256. While the clock is stopped, the result is
  // 256 if the current level is high, else 0.
  int high_counts(unsigned channel, States at) const;
  // Returns the level of the waveform at `at`.
  bool level(unsigned channel, States at, bool right_aligned) const;
  // Returns the time of the first change of level() after the time `at`; kNever if the level is constant.
  States next_change(unsigned channel, States at, bool right_aligned) const;

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(oe_, os_, select_, pcsr_, data_, epoch_, base_, base_count_);
  }

 private:
  // Returns the number of states per count, a power of two; 0: the clock is stopped.
  States divisor() const {
    if (!(select_ & PWSL::PWCKE)) return 0;
    return select_ & PWSL::PWCKS ? States{2} << field<PCSR::PWCK>(pcsr_) : 1;
  }
  States tick(States at) const { return (at - epoch_) / divisor(); }
  unsigned counter(States at) const;

  std::uint16_t oe_ = 0, os_ = 0;
  std::uint8_t select_ = PWSL::ONE, pcsr_ = 0;
  std::array<std::uint8_t, 16> data_{};
  // The counter was `base_count_` at time `base_`.
  States epoch_, base_;
  unsigned base_count_ = 0;
};

// Returns whether `count` (0..255, within the conversion period) is inside a pulse. `data` is the value of
// PWDR. The result does not include the inversion by bit OS.
bool pwm_pulse(std::uint8_t data, unsigned count, bool right_aligned);

}  // namespace kaz::h8s
