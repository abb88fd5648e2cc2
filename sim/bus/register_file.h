// The memory of a virtual servo: registers, what stays of them without power, and the lock.
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
  // As from the factory.
  explicit RegisterFile(const servo_bus::Model& model);

  const servo_bus::Model& model() const { return *model_; }
  bool has(std::string_view name) const { return model_->find(name) != nullptr; }
  // `otherwise` where the model has no such register.
  int get(std::string_view name, int otherwise = 0) const;
  int get(const servo_bus::Register& reg, int index = 0) const;
  // As the servo itself writes, read-only ones too; within what the register holds. Nothing where the model
  // has none of that name.
  void set(std::string_view name, int value);
  // The `index`-th of a row, kept without power if it is EEPROM and not locked.
  void write(const servo_bus::Register& reg, int index, int value);

  // As a host of Feetech's writes: read-only registers and addresses without a register are skipped, values
  // limited to their range. Returns what was written to, by address.
  std::vector<const servo_bus::Register*> write(std::size_t address,
                                                std::span<const std::uint8_t> bytes);
  // Addresses without a register read 0.
  std::vector<std::uint8_t> read(std::size_t address, std::size_t length) const;

  // EEPROM as it was written while unlocked, RAM as it begins.
  void power_on();
  bool locked() const { return get("lock") != 0; }
  using Chosen = std::function<bool(const servo_bus::Register&)>;
  // Keeps all registers for restore(), which puts back those that are chosen, EEPROM also as kept without
  // power.
  void backup() { backup_ = live_; }
  void restore(const Chosen& chosen);
  // As from the factory.
  void reset(const Chosen& chosen);
  // Keeps a register's present value without power, whatever the lock.
  void keep(std::string_view name);

 private:
  using Bytes = std::vector<std::uint8_t>;
  void put(Bytes& bytes, const servo_bus::Register& reg, int index, int value) const;
  void put_initial(Bytes& bytes, const servo_bus::Register& reg) const;
  void copy(const Bytes& from, Bytes& to, const servo_bus::Register& reg) const;

  const servo_bus::Model* model_;
  Bytes live_, stored_, backup_;
};

}  // namespace kaz::sim
