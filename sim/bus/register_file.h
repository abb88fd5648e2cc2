// The memory of a virtual servo: registers, EEPROM and the lock.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "shared/servo_bus/registers.h"

namespace kaz::sim {

class RegisterFile {
 public:
  // Initializes all registers with factory values. `model` must outlive the object.
  explicit RegisterFile(const servo_bus::Model& model);

  const servo_bus::Model& model() const { return *model_; }
  bool has(std::string_view name) const { return model_->find(name) != nullptr; }
  // Returns `otherwise` if the model has no such register.
  int get(std::string_view name, int otherwise = 0) const;
  int get(const servo_bus::Register& reg, int index = 0) const;
  // Writes a register as the servo itself does, read-only ones too. Clamps the value to the register's range;
  // in writable DYNAMIXEL registers only to its size. No effect if the model has no such register.
  void set(std::string_view name, int value);
  // Writes the `index`-th register of a row. EEPROM keeps the value without power unless it is locked.
  void write(const servo_bus::Register& reg, int index, int value);

  // Writes bytes as a Feetech host does. Skips read-only registers and addresses without a register, and
  // clamps values to their range. Returns the written registers, by address.
  std::vector<const servo_bus::Register*> write(std::size_t address,
                                                std::span<const std::uint8_t> bytes);
  // Addresses without a register read 0.
  std::vector<std::uint8_t> read(std::size_t address, std::size_t length) const;

  // Resets EEPROM to the values written while unlocked, and RAM to its initial values.
  void power_on();
  bool locked() const { return get("lock") != 0; }
  using Chosen = std::function<bool(const servo_bus::Register&)>;
  // Saves all registers for restore(), which loads the chosen ones. Restored EEPROM values stay without
  // power.
  void backup() { backup_ = live_; }
  void restore(const Chosen& chosen);
  // Sets the chosen registers to factory values.
  void reset(const Chosen& chosen);
  // Stores the present value of a register so that it stays without power, even if EEPROM is locked.
  void keep(std::string_view name);

 private:
  using Bytes = std::vector<std::uint8_t>;
  void put(Bytes& bytes, const servo_bus::Register& reg, int index, int value) const;
  void put_initial(Bytes& bytes, const servo_bus::Register& reg) const;
  void copy(const Bytes& from, Bytes& to, const servo_bus::Register& reg) const;

  const servo_bus::Model* model_;
  Bytes live_, stored_, backup_;  // present values, EEPROM without power, values of backup()
};

}  // namespace kaz::sim
