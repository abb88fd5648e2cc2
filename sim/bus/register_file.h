// The memory of a virtual servo: registers, what stays of them without power, and the lock.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "shared/feetech/registers.h"

namespace kaz::sim {

class RegisterFile {
 public:
  // As from the factory.
  explicit RegisterFile(const feetech::Model& model);

  const feetech::Model& model() const { return *model_; }
  bool has(std::string_view name) const { return model_->find(name) != nullptr; }
  // `otherwise` where the model has no such register.
  int get(std::string_view name, int otherwise = 0) const;
  // As the servo itself writes, read-only ones too; within the register's range. Nothing where the model has
  // none of that name.
  void set(std::string_view name, int value);

  // As a host writes: read-only registers and addresses without a register are skipped, values limited to
  // their range. Returns what was written to, by address.
  std::vector<const feetech::Register*> write(std::uint8_t address,
                                              std::span<const std::uint8_t> bytes);
  // Addresses without a register read 0.
  std::vector<std::uint8_t> read(std::uint8_t address, std::size_t length) const;

  // EEPROM as it was written while unlocked, RAM as it begins.
  void power_on();
  bool locked() const { return get("lock") != 0; }
  // Keeps EEPROM registers for restore(), and puts them back, but for the id. Only while unlocked.
  void backup();
  void restore();
  // Keeps a register's present value without power, whatever the lock.
  void keep(std::string_view name);

 private:
  using Bytes = std::array<std::uint8_t, 256>;
  void put(Bytes& bytes, const feetech::Register& reg, int value) const;
  void copy(const Bytes& from, Bytes& to, const feetech::Register& reg) const;

  const feetech::Model* model_;
  Bytes live_{}, stored_{}, backup_{};
};

}  // namespace kaz::sim
