// Registers of servo models as their makers publish them, for the judge alone.
// SPDX-License-Identifier: Apache-2.0
//
// From shared/*/corpus/*.csv, which were transcribed apart from the tables that drivers and virtual servos
// use: an error there cannot hide here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/bus/servo_wire.h"

namespace kaz::hil {

struct ServoRow {
  int address = 0, size = 1;  // bytes
  int sign_bit = 0;           // 0: unsigned
  bool writable = false, eeprom = false;
  std::optional<long> factory;
  long min = 0, max = 0;  // of a writable one
  std::string what;

  long highest() const { return (1L << (sign_bit != 0 ? sign_bit : 8 * size)) - 1; }
};

struct ServoTable {
  std::string model;
  ServoFamily family = ServoFamily::feetech;
  std::vector<ServoRow> rows;  // by address

  bool big_endian() const;
  // The row must be there.
  const ServoRow& row(std::string_view what) const;
  // Null: this model has none. Rows have different names in different tables: the first that is there.
  const ServoRow* find(std::initializer_list<std::string_view> names) const;
  const ServoRow& model_row() const;
};

const std::vector<ServoTable>& servo_tables();

long decode(const ServoTable& table, const ServoRow& row, const Bytes& bytes);
Bytes encode(const ServoTable& table, const ServoRow& row, long value);

}  // namespace kaz::hil
