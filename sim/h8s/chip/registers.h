// The names of the I/O registers: one table for reports, debuggers and recordings.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace kaz::h8s {

// Condition that selects a register among those that share its address (hardware manual, register list).
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
  regs_0,  // IICE = 1, and REGS in DADRB or DACNT
  regs_1,
};

struct RegisterInfo {
  std::string_view name;  // as in the manual; with the unit's number where several units have it
  std::uint16_t address;  // the lower 16 bits
  std::uint8_t size;      // bytes: 1 or 2
  std::string_view unit;
  Bank bank = Bank::always;
  bool write_only = false;  // reads are undefined
  // The 24-bit address.
  std::uint32_t full_address() const { return 0xff0000u | address; }
};

std::span<const RegisterInfo> register_table();
// Finds a register by name, ignoring case; null: none.
const RegisterInfo* find_register(std::string_view name);
// The register at this address, among several the selected one; null: none. `peek` reads a byte
// without side effects.
const RegisterInfo* register_at(
    std::uint32_t address, const std::function<std::optional<std::uint8_t>(std::uint32_t)>& peek);
// Whether a register is the selected one at its address.
bool selected(const RegisterInfo& r,
              const std::function<std::optional<std::uint8_t>(std::uint32_t)>& peek);

}  // namespace kaz::h8s
