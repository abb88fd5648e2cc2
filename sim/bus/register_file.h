// Memory of a virtual servo: registers, EEPROM, and the lock of the EEPROM.
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
  // Returns the value of a register, or `otherwise` if the model does not have the register.
  int get(std::string_view name, int otherwise = 0) const;
  int get(const servo_bus::Register& reg, int index = 0) const;
  // Writes a register on behalf of the servo's firmware. Registers that are read-only for a host are written
  // too. Clamps the value to the register's range. Exception: a writable DYNAMIXEL register can also get
  // a value outside its range. If such a value does not fit into the register's bytes, the function clamps
  // the value to the nearest value that fits. The function has no effect if the model does not have the
  // register.
  void set(std::string_view name, int value);
  // Writes one of the consecutive registers that `reg` describes. `index` is the number of this register,
  // counted from 0. If the register is in the EEPROM and the EEPROM is not locked, the value is also kept
  // without power.
  void write(const servo_bus::Register& reg, int index, int value);

  // Writes bytes that a host has sent to a Feetech servo. Skips read-only registers and addresses without a
  // register. Clamps each value to the range of the register. Returns the written registers, sorted by
  // address.
  std::vector<const servo_bus::Register*> write(std::size_t address,
                                                std::span<const std::uint8_t> bytes);
  // Returns the bytes at `length` addresses, beginning with `address`. For an address without a register,
  // the returned byte is 0.
  std::vector<std::uint8_t> read(std::size_t address, std::size_t length) const;

  // Sets EEPROM registers to the values that are kept without power, and RAM registers to initial values.
  void power_on();
  bool locked() const { return get("lock") != 0; }
  using Chosen = std::function<bool(const servo_bus::Register&)>;
  // backup() saves all registers. restore() loads the chosen registers from the backup. If restore() loads
  // an EEPROM register, the loaded value is kept without power.
  void backup() { backup_ = live_; }
  void restore(const Chosen& chosen);
  // Sets the chosen registers to factory values.
  void reset(const Chosen& chosen);
  // Stores the present value of a register so that the value is kept without power, even if EEPROM is locked.
  void keep(std::string_view name);

 private:
  using Bytes = std::vector<std::uint8_t>;
  void put(Bytes& bytes, const servo_bus::Register& reg, int index, int value) const;
  void put_initial(Bytes& bytes, const servo_bus::Register& reg) const;
  void copy(const Bytes& from, Bytes& to, const servo_bus::Register& reg) const;

  const servo_bus::Model* model_;
  // live_: present values. stored_: values that are kept without power. backup_: values that backup() saved.
  Bytes live_, stored_, backup_;
};

}  // namespace kaz::sim
