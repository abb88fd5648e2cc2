// Registers of servo models as their makers publish them.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bus/servo_table.h"

#include <algorithm>
#include <stdexcept>

namespace kaz::hil {
namespace {

std::vector<ServoTable> all_tables() {
  constexpr ServoFamily feetech = ServoFamily::feetech, dynamixel = ServoFamily::dynamixel;
  return {
#define KZ_TABLE(model, family) {model, family, {
#define KZ_ROW(address, size, sign, writable, eeprom, factory, low, high, what) \
  {address, size, sign, writable, eeprom, factory, low, high, what},
#define KZ_TABLE_END \
  }                  \
  }                  \
  ,
#include "kz_servo_corpus.h"
#undef KZ_TABLE
#undef KZ_ROW
#undef KZ_TABLE_END
  };
}

}  // namespace

const std::vector<ServoTable>& servo_tables() {
  static const std::vector<ServoTable> all = all_tables();
  return all;
}

// Of Feetech's the SCS series alone.
bool ServoTable::big_endian() const {
  return model.starts_with("scs");
}

const ServoRow& ServoTable::row(std::string_view what) const {
  const auto found = std::ranges::find(rows, what, &ServoRow::what);
  if (found == rows.end())
    throw std::logic_error("the register table of " + model + " has no register '" +
                           std::string(what) + "'");
  return *found;
}

const ServoRow* ServoTable::find(std::initializer_list<std::string_view> names) const {
  for (const std::string_view name : names) {
    const auto found = std::ranges::find(rows, name, &ServoRow::what);
    if (found != rows.end()) return &*found;
  }
  return nullptr;
}

const ServoRow& ServoTable::model_row() const {
  return row(family == ServoFamily::feetech ? "servo model" : "Model Number");
}

long decode(const ServoTable& table, const ServoRow& row, const Bytes& bytes) {
  long value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::size_t place = table.big_endian() ? bytes.size() - 1 - i : i;
    value |= static_cast<long>(bytes[i]) << (8 * place);
  }
  if (row.sign_bit == 0 || (value >> row.sign_bit & 1) == 0) return value;
  // Feetech: the sign bit and a magnitude; DYNAMIXEL: two's complement.
  return table.family == ServoFamily::feetech ? -(value & ((1L << row.sign_bit) - 1))
                                              : value - (1L << (row.sign_bit + 1));
}

Bytes encode(const ServoTable& table, const ServoRow& row, long value) {
  if (value < 0 && table.family == ServoFamily::feetech) value = -value | 1L << row.sign_bit;
  Bytes bytes(static_cast<std::size_t>(row.size));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::size_t place = table.big_endian() ? bytes.size() - 1 - i : i;
    bytes[i] = static_cast<std::uint8_t>(value >> (8 * place));
  }
  return bytes;
}

}  // namespace kaz::hil
