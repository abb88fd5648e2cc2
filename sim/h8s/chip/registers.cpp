// The table of I/O registers, from registers.def.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/registers.h"

#include <algorithm>
#include <cctype>

#include "sim/h8s/chip/register_names.h"

namespace kaz::h8s {
namespace {

using enum Bank;

constexpr RegisterInfo kRegisters[] = {
#define KZ_REGISTER(name, address, size, unit) {#name, address, size, #unit},
#define KZ_BANKED(name, address, size, unit, bank) {#name, address, size, #unit, bank},
#define KZ_WRITE_ONLY(name, address, size, unit) {#name, address, size, #unit, always, true},
#include "sim/h8s/chip/registers.def"
};

bool is_set(const Peek& peek, std::uint32_t address, unsigned mask) {
  return (peek(0xff0000 | address).value_or(0) & mask) != 0;
}

}  // namespace

std::span<const RegisterInfo> register_table() {
  return kRegisters;
}

const RegisterInfo* find_register(std::string_view name) {
  const auto same = [](char x, char y) {
    return std::toupper(static_cast<unsigned char>(x)) ==
           std::toupper(static_cast<unsigned char>(y));
  };
  for (const RegisterInfo& r : kRegisters) {
    if (std::equal(r.name.begin(), r.name.end(), name.begin(), name.end(), same)) return &r;
  }
  return nullptr;
}

bool selected(const RegisterInfo& r, const Peek& peek) {
  switch (r.bank) {
    case always:
      return true;
    case flshe_0:
    case flshe_1:
      return is_set(peek, io::STCR, STCR::FLSHE) == (r.bank == flshe_1);
    case iice_0:
    case iice_1:
      return is_set(peek, io::STCR, STCR::IICE) == (r.bank == iice_1);
    case tmrx:
    case tmry:
      return is_set(peek, io::TCONRS, TCONRS::TMRXY) == (r.bank == tmry);
    case ocrs_0:
    case ocrs_1:
      return is_set(peek, io::TOCR, TOCR::OCRS) == (r.bank == ocrs_1);
    case icrs_0:
    case icrs_1:
      return is_set(peek, io::TOCR, TOCR::ICRS) == (r.bank == icrs_1);
    case regs_0:
    case regs_1:
      return is_set(peek, io::STCR, STCR::IICE) &&
             is_set(peek, io::DADRB + 1, DADR::REGS) == (r.bank == regs_1);
  }
  return false;
}

const RegisterInfo* register_at(std::uint32_t address, const Peek& peek) {
  const std::uint32_t a = address & 0xffff;
  for (const RegisterInfo& r : kRegisters) {
    if (a >= r.address && a < r.address + std::uint32_t{r.size} && selected(r, peek)) return &r;
  }
  return nullptr;
}

}  // namespace kaz::h8s
