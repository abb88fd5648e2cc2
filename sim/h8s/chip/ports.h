// Ports 1..7: data direction, latches, pull-ups, and which module owns a pin.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "sim/h8s/chip/chip.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class Ports {
 public:
  // Registers by low 16 bits, FFAC..FFBE; nullopt or false where there is none.
  std::optional<std::uint8_t> read(const Machine& m, std::uint32_t address) const;
  bool write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  // Whether writing a latch or direction changes nothing.
  bool holds(std::uint32_t address, std::uint8_t value) const;
  // Levels driven by the board are kept.
  void reset();

  PortOutput output(const Machine& m, unsigned port, States at) const;
  // Levels read at the pins: own outputs, the board's levels, pull-ups.
  std::uint8_t pins(const Machine& m, unsigned port, States at) const;
  void set_input(Machine& m, unsigned port, unsigned bit, std::optional<bool> level, States at);

  std::uint8_t ddr(unsigned port) const { return ddr_[port]; }
  std::uint8_t dr(unsigned port) const { return dr_[port]; }
  bool pulled_up(unsigned port, unsigned bit) const { return (pcr_[port] >> bit & 1) != 0; }
  bool given(unsigned port, unsigned bit) const { return (given_[port] >> bit & 1) != 0; }

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(ddr_, dr_, pcr_, given_, level_);
  }

 private:
  std::array<std::uint8_t, 8> ddr_{}, dr_{}, pcr_{};  // by port number
  std::array<std::uint8_t, 8> given_{}, level_{};     // driven by the board, and the level
};

}  // namespace kaz::h8s
