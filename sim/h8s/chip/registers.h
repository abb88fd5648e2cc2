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

// Which of the registers that share an address answers (hardware manual, register list).
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
  std::string_view name;  // as in the manual; units with the same register add their number
  std::uint16_t address;  // the lower 16 bits
  std::uint8_t size;      // bytes: 1 or 2
  std::string_view unit;
  Bank bank = Bank::always;
  bool write_only = false;  // a read gives nothing of use
  // Of the chip with its addresses of 24 bits.
  std::uint32_t full_address() const { return 0xff0000u | address; }
};

std::span<const RegisterInfo> register_table();
// By name in either case; null: there is none.
const RegisterInfo* find_register(std::string_view name);
// The register that holds this address, of those that share it the one that `peek` (a byte of an
// address, without side effects) shows to be selected; null: none.
const RegisterInfo* register_at(
    std::uint32_t address, const std::function<std::optional<std::uint8_t>(std::uint32_t)>& peek);
// Whether a register is the selected one of its address.
bool selected(const RegisterInfo& r,
              const std::function<std::optional<std::uint8_t>(std::uint32_t)>& peek);

}  // namespace kaz::h8s
