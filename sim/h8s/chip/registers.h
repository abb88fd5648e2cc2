// Table of the I/O registers by name, for reports, debuggers and recordings.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

namespace kaz::h8s {

// Condition that selects one of the registers that share an address (hardware manual, register list).
enum class Bank : std::uint8_t {
  always,
  flshe_0,  // STCR.FLSHE
  flshe_1,
  iice_0,  // STCR.IICE
  iice_1,
  tmrx,  // TCONRS.TMRX/Y
  tmry,
  ocrs_0,  // TOCR.OCRS
  ocrs_1,
  icrs_0,  // TOCR.ICRS
  icrs_1,
  regs_0,  // condition: STCR.IICE is 1 and bit REGS is 0 (REGS is a bit of DADRB and DACNT)
  regs_1,  // condition: STCR.IICE is 1 and bit REGS is 1 (REGS is a bit of DADRB and DACNT)
};

struct RegisterInfo {
  std::string_view name;  // name in the manual, with a unit number if necessary
  std::uint16_t address;  // low 16 bits of the address
  std::uint8_t size;      // size in bytes: 1 or 2
  std::string_view unit;
  Bank bank = Bank::always;
  bool write_only = false;  // reads are undefined
  // Returns the 24-bit address.
  std::uint32_t full_address() const { return 0xff0000u | address; }
};

// Reads a byte without side effects, like Chip::peek.
using Peek = std::function<std::optional<std::uint8_t>(std::uint32_t)>;

// Returns the table in the order of addresses.
std::span<const RegisterInfo> register_table();
// Finds a register by name, ignoring case. Returns null if there is no such register.
const RegisterInfo* find_register(std::string_view name);
// Returns the register at `address`, or null if there is no register. If several registers share the address,
// returns the selected register.
const RegisterInfo* register_at(std::uint32_t address, const Peek& peek);
// Returns whether `r` is the selected register at its address.
bool selected(const RegisterInfo& r, const Peek& peek);

}  // namespace kaz::h8s
