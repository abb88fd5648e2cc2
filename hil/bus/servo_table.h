// Registers of servo models, as published by the makers. Only the conformance cases use this table.
// SPDX-License-Identifier: Apache-2.0
//
// Generated from shared/*/corpus/*.csv. The CSV files were transcribed independently of the register tables
// of drivers and virtual servos. Therefore the conformance cases can detect errors in the register tables of
// drivers and virtual servos.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/bus/servo_wire.h"

namespace kaz::hil {

struct ServoRow {
  int address = 0, size = 1;  // bytes
  int sign_bit = 0;           // number of the sign bit; 0: unsigned
  bool writable = false, eeprom = false;
  std::optional<long> factory;
  long min = 0, max = 0;  // range of a writable register
  std::string what;

  long highest() const { return (1L << (sign_bit != 0 ? sign_bit : 8 * size)) - 1; }
};

struct ServoTable {
  std::string model;
  ServoFamily family = ServoFamily::feetech;
  std::vector<ServoRow> rows;  // by address

  bool big_endian() const;
  // Returns the row with this name. If there is no row with this name, throws std::logic_error.
  const ServoRow& row(std::string_view what) const;
  // Returns the first row that has one of these names, or null. Several names are needed because tables use
  // different names for the same register.
  const ServoRow* find(std::initializer_list<std::string_view> names) const;
  const ServoRow& model_row() const;
};

const std::vector<ServoTable>& servo_tables();

// Convert between a register value and its bytes on the wire, with the table's byte order and sign format.
long decode(const ServoTable& table, const ServoRow& row, const Bytes& bytes);
Bytes encode(const ServoTable& table, const ServoRow& row, long value);

}  // namespace kaz::hil
