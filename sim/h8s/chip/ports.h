// I/O ports 1..7: data direction, latches, pull-ups, and the module that drives each pin.
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
  // Register accesses. `address` contains only the low 16 bits of the address: P1PCR..P7PIN. These functions
  // return nullopt or false if the address does not belong to a register of a port.
  std::optional<std::uint8_t> read(const Machine& m, std::uint32_t address) const;
  bool write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  // Returns true if the register at `address` is a latch or direction register and already contains `value`.
  bool holds(std::uint32_t address, std::uint8_t value) const;
  // Resets the registers, but keeps the levels that the board drives.
  void reset();

  PortOutput output(const Machine& m, unsigned port, States at) const;
  // Returns the levels at the pins of a port. The levels come from outputs of the chip, from the board or
  // from pull-ups.
  std::uint8_t pins(const Machine& m, unsigned port, States at) const;
  // Sets the level that the board drives; nullopt: the board stops driving the pin.
  void set_input(Machine& m, unsigned port, unsigned bit, std::optional<bool> level, States at);

  std::uint8_t ddr(unsigned port) const { return ddr_[port]; }
  std::uint8_t dr(unsigned port) const { return dr_[port]; }
  bool pulled_up(unsigned port, unsigned bit) const { return (pcr_[port] >> bit & 1) != 0; }
  bool given(unsigned port, unsigned bit) const { return (given_[port] >> bit & 1) != 0; }

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(ddr_, dr_, pcr_, given_, level_);
  }

 private:
  std::array<std::uint8_t, 8> ddr_{}, dr_{}, pcr_{};  // registers, indexed by port number
  // Pins that the board drives; levels of these pins.
  std::array<std::uint8_t, 8> given_{}, level_{};
};

}  // namespace kaz::h8s
