// Register tables of Feetech's servos: one .def file per model is their only source.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace kaz::feetech {

struct Register {
  std::string_view name;
  std::uint8_t address = 0;
  std::uint8_t size = 1;  // bytes, 1 or 2
  // Bit of the sign, magnitude below it; 0: unsigned. Feetech has no two's complement.
  std::uint8_t sign_bit = 0;
  bool writable = false;
  bool eeprom = false;  // kept without power; else RAM
  int initial = 0;
  int min = 0, max = 0;  // values written are limited to these
  std::string_view unit;
  std::string_view effect;
  std::string_view source;
};

struct Model {
  std::string_view name;  // "sts3215"
  std::string_view title;
  int number = 0;           // in the register `model`
  bool big_endian = false;  // of 2-byte registers
  int steps = 0;            // of the position sensor over span_rad
  double span_rad = 0;
  bool full_turn = false;               // the sensor goes on from its last step to its first
  bool sync_read = false;               // also 0A and 0B, as newer models have
  int protection_unit_ms = 0;           // of the register `protection_time`
  std::span<const Register> registers;  // by address

  // Null: this model has none of that name.
  const Register* find(std::string_view name) const;
  // The register that holds the byte at `address`; null: none.
  const Register* at(std::uint8_t address) const;
  double steps_per_rad() const { return steps / span_rad; }
};

std::span<const Model> models();
// Null: unknown.
const Model* find_model(std::string_view name);

// Value of a register's bytes, and back. A magnitude that does not fit below the sign bit is limited.
int decode(const Model& model, const Register& reg, std::span<const std::uint8_t> bytes);
std::vector<std::uint8_t> encode(const Model& model, const Register& reg, int value);

// Rates by the code in the register `baud_rate` (Feetech's SDKs and memory tables), baud.
inline constexpr long kBaudRates[] = {1000000, 500000, 250000, 128000, 115200, 76800, 57600, 38400};
// Unit of the register `return_delay`, ns.
inline constexpr int kReturnDelayUnitNs = 2000;

}  // namespace kaz::feetech
