// Register tables of servos that people own: one .def file per model is their only source.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace kaz::servo_bus {

// What passes over the wire: shared/feetech, shared/dynamixel.
enum class Protocol : std::uint8_t { feetech, dynamixel };
std::string_view name_of(Protocol protocol);
// Of servos as they are sold, baud.
long factory_baud(Protocol protocol);

struct Register {
  std::string_view name;
  std::uint16_t address = 0;
  std::uint8_t size = 1;  // bytes, 1, 2 or 4
  // Bit of the sign; 0: unsigned. Feetech has the magnitude below it, DYNAMIXEL two's complement.
  std::uint8_t sign_bit = 0;
  bool writable = false;
  bool eeprom = false;  // kept without power; else RAM
  int initial = 0;
  int min = 0, max = 0;  // what can be written
  std::string_view unit;
  std::string_view effect;
  std::string_view source;
  int count = 1;                 // so many in a row
  int initial_step = 0;          // from one of them to the next
  std::string_view values = {};  // "0 1 3": these alone can be written; empty: all from min to max

  int end() const { return address + size * count; }
  bool allows(int value) const;
};

// A model that is another one but for some initial values.
struct Change {
  std::string_view model, name;
  int initial = 0;
};

struct Model {
  std::string_view name;  // "sts3215"
  std::string_view title;
  Protocol protocol = Protocol::feetech;
  int number = 0;           // in the register of the model's number
  bool big_endian = false;  // of registers of several bytes
  int steps = 0;            // of the position sensor over span_rad
  double span_rad = 0;
  bool full_turn = false;               // the sensor goes on from its last step to its first
  bool sync_read = false;               // Feetech: also 0A and 0B, as newer models have
  int protection_unit_ms = 0;           // Feetech: of the register `protection_time`
  int position_p_unit = 0;              // DYNAMIXEL: what the register is divided by
  double current_unit_a = 0;            // DYNAMIXEL: 0 if it measures no current
  double free_rpm_per_volt = 0;         // DYNAMIXEL: without load
  std::span<const long> bauds;          // by the code in the register `baud_rate`
  std::span<const Register> registers;  // by address

  // Null: this model has none of that name.
  const Register* find(std::string_view name) const;
  // The register that holds the byte at `address`; null: none.
  const Register* at(std::size_t address) const;
  // Of the `index`-th of a row, as from the factory.
  int initial(const Register& reg, int index = 0) const;
  std::size_t end() const {
    return registers.empty() ? 0 : static_cast<std::size_t>(registers.back().end());
  }
  double steps_per_rad() const { return steps / span_rad; }
};

std::span<const Model> models();
// Null: unknown.
const Model* find_model(std::string_view name);

// Value of a register's bytes, and back. A value that does not fit is limited.
int decode(const Model& model, const Register& reg, std::span<const std::uint8_t> bytes);
std::vector<std::uint8_t> encode(const Model& model, const Register& reg, int value);

// Unit of the registers `return_delay` and `return_delay_time`, ns.
inline constexpr int kReturnDelayUnitNs = 2000;

}  // namespace kaz::servo_bus
