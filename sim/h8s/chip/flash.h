// The flash controller: programming and erasing by the steps that the manual prescribes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class FlashControl {
 public:
  // FF80..FF83 while STCR.FLSHE = 1: FLMCR1, FLMCR2, EBR1, EBR2.
  std::uint8_t peek(std::uint32_t address) const;
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  // A byte written by the program to an address inside the flash.
  void latch(Machine& m, std::uint32_t address, std::uint8_t value);
  bool enabled() const { return (flmcr1_ & 0x40) != 0; }

 private:
  void program(Machine& m, States pulse);
  void erase(Machine& m, States pulse);

  std::uint8_t flmcr1_ = 0x80, flmcr2_ = 0, ebr1_ = 0, ebr2_ = 0;
  std::uint32_t line_ = 0;
  std::uint32_t latched_ = 0;  // one bit a byte of the line
  std::array<std::uint8_t, 32> data_{};
  States pulse_start_ = 0;
};

}  // namespace kaz::h8s
