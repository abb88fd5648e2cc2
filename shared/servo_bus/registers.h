// Register tables of servo models, and conversion of register values.
// Each model family has one .def file (shared/feetech, shared/dynamixel).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace kaz::servo_bus {

// Wire protocol of a servo.
enum class Protocol : std::uint8_t { feetech, dynamixel };
// Returns "feetech" or "dynamixel".
std::string_view name_of(Protocol protocol);
// Returns the factory setting of the baud rate.
long factory_baud(Protocol protocol);

struct Register {
  std::string_view name;
  std::uint16_t address = 0;
  std::uint8_t size = 1;  // bytes: 1, 2 or 4
  // Number of the sign bit; 0: unsigned. Feetech servos store negative values as sign and magnitude.
  // DYNAMIXEL servos store negative values in two's complement.
  std::uint8_t sign_bit = 0;
  bool writable = false;
  bool eeprom = false;   // true: EEPROM, which keeps the value without power; false: RAM
  int initial = 0;       // factory value
  int min = 0, max = 0;  // range of writable values
  std::string_view unit;
  // Purpose of the register. If the purpose is in brackets, the simulator only stores the value of the
  // register.
  std::string_view effect;
  std::string_view source;  // letters, explained in the .def file
  int count = 1;            // number of consecutive registers that this entry describes
  int initial_step = 0;     // register i has the factory value initial + i * initial_step
  // List of the values that may be written, such as "0 1 3". If the list is empty, all values from min to max
  // may be written.
  std::string_view values = {};

  // Returns the address after the register.
  int end() const { return address + size * count; }
  // Returns whether the register allows the value. Ignores `writable`.
  bool allows(int value) const;
};

// Factory value of a register in one model. Used if models have a common register table but different factory
// values.
struct Change {
  std::string_view model, name;
  int initial = 0;
};

struct Model {
  std::string_view name;  // "sts3215"
  std::string_view title;
  Protocol protocol = Protocol::feetech;
  int number = 0;           // content of the model number register
  bool big_endian = false;  // byte order of registers
  int steps = 0;            // steps of the position sensor over span_rad
  double span_rad = 0;
  // True: the position sensor measures a full turn and then starts again at 0. If `full_turn` is true, a
  // Feetech model also has the instructions `reset_turns` and `set_middle`.
  bool full_turn = false;
  bool sync_read = false;      // supports sync read
  int protection_unit_ms = 0;  // Feetech: unit of the register `protection_time`
  int position_p_unit = 0;     // DYNAMIXEL: divisor of `position_p_gain`
  double current_unit_a = 0;   // DYNAMIXEL: unit of current, A; 0: not measured
  // DYNAMIXEL: true if the current sensor is in the supply line of the bridge, false if it is in the
  // winding's circuit.
  bool senses_supply_current = false;
  double free_rpm_per_volt = 0;  // DYNAMIXEL: no-load speed
  std::span<const long> bauds;   // baud rates; the index is the code in the register `baud_rate`
  std::span<const Register> registers;  // sorted by address

  // Returns the register with this name, or null.
  const Register* find(std::string_view name) const;
  // Returns the register that contains the byte at `address`, or null.
  const Register* at(std::size_t address) const;
  // Returns the factory value of a register. If `reg` describes several consecutive registers, `index` is the
  // number of the register among these registers, counted from 0.
  int initial(const Register& reg, int index = 0) const;
  // Returns the address after the last register.
  std::size_t end() const {
    return registers.empty() ? 0 : static_cast<std::size_t>(registers.back().end());
  }
  double steps_per_rad() const { return steps / span_rad; }
};

// Returns all known models.
std::span<const Model> models();
// Returns the model with this name, or null.
const Model* find_model(std::string_view name);

// Convert between a register's bytes on the wire and its value. decode() returns 0 for too few bytes.
// encode() clamps values that do not fit.
int decode(const Model& model, const Register& reg, std::span<const std::uint8_t> bytes);
std::vector<std::uint8_t> encode(const Model& model, const Register& reg, int value);

// Unit of the registers `return_delay` and `return_delay_time`, ns.
inline constexpr int kReturnDelayUnitNs = 2000;

}  // namespace kaz::servo_bus
