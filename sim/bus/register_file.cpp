// The memory of a virtual servo.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/register_file.h"

#include <algorithm>

namespace kaz::sim {

using feetech::Register;

RegisterFile::RegisterFile(const feetech::Model& model) : model_(&model) {
  for (const Register& reg : model.registers) put(stored_, reg, reg.initial);
  backup_ = stored_;
  power_on();
}

void RegisterFile::put(Bytes& bytes, const Register& reg, int value) const {
  std::ranges::copy(feetech::encode(*model_, reg, value), bytes.begin() + reg.address);
}

void RegisterFile::copy(const Bytes& from, Bytes& to, const Register& reg) const {
  std::copy_n(from.begin() + reg.address, reg.size, to.begin() + reg.address);
}

int RegisterFile::get(std::string_view name, int otherwise) const {
  const Register* reg = model_->find(name);
  return reg == nullptr ? otherwise
                        : feetech::decode(*model_, *reg, std::span(live_).subspan(reg->address));
}

void RegisterFile::set(std::string_view name, int value) {
  if (const Register* reg = model_->find(name))
    put(live_, *reg, std::clamp(value, reg->min, reg->max));
}

std::vector<const Register*> RegisterFile::write(std::uint8_t address,
                                                 std::span<const std::uint8_t> bytes) {
  const bool keeps = !locked();
  std::vector<const Register*> written;
  for (std::size_t i = 0; i < bytes.size() && address + i < live_.size(); ++i) {
    const auto at = static_cast<std::uint8_t>(address + i);
    const Register* reg = model_->at(at);
    if (reg == nullptr || !reg->writable) continue;
    live_[at] = bytes[i];
    if (written.empty() || written.back() != reg) written.push_back(reg);
  }
  for (const Register* reg : written) {
    const int value = feetech::decode(*model_, *reg, std::span(live_).subspan(reg->address));
    put(live_, *reg, std::clamp(value, reg->min, reg->max));
    if (reg->eeprom && keeps) copy(live_, stored_, *reg);
  }
  return written;
}

std::vector<std::uint8_t> RegisterFile::read(std::uint8_t address, std::size_t length) const {
  std::vector<std::uint8_t> bytes(length);
  for (std::size_t i = 0; i < length && address + i < live_.size(); ++i)
    bytes[i] = live_[address + i];
  return bytes;
}

void RegisterFile::power_on() {
  for (const Register& reg : model_->registers) {
    if (reg.eeprom) {
      copy(stored_, live_, reg);
    } else {
      put(live_, reg, reg.initial);
    }
  }
  set("torque_limit", get("max_torque"));
}

void RegisterFile::backup() {
  if (!locked()) backup_ = live_;
}

void RegisterFile::restore() {
  if (locked()) return;
  for (const Register& reg : model_->registers) {
    if (!reg.eeprom || reg.name == "id") continue;
    copy(backup_, live_, reg);
    copy(backup_, stored_, reg);
  }
}

void RegisterFile::keep(std::string_view name) {
  if (const Register* reg = model_->find(name)) copy(live_, stored_, *reg);
}

}  // namespace kaz::sim
