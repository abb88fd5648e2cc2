// The memory of a virtual servo.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/register_file.h"

#include <algorithm>

namespace kaz::sim {

using servo_bus::Register;

RegisterFile::RegisterFile(const servo_bus::Model& model)
    : model_(&model), live_(model.end()), stored_(model.end()) {
  for (const Register& reg : model.registers) put_initial(stored_, reg);
  backup_ = stored_;
  power_on();
}

void RegisterFile::put(Bytes& bytes, const Register& reg, int index, int value) const {
  std::ranges::copy(servo_bus::encode(*model_, reg, value),
                    bytes.begin() + reg.address + index * reg.size);
}

void RegisterFile::put_initial(Bytes& bytes, const Register& reg) const {
  for (int i = 0; i < reg.count; ++i) put(bytes, reg, i, model_->initial(reg, i));
}

void RegisterFile::copy(const Bytes& from, Bytes& to, const Register& reg) const {
  std::copy(from.begin() + reg.address, from.begin() + reg.end(), to.begin() + reg.address);
}

int RegisterFile::get(std::string_view name, int otherwise) const {
  const Register* reg = model_->find(name);
  return reg == nullptr ? otherwise : get(*reg);
}

int RegisterFile::get(const Register& reg, int index) const {
  const auto at = static_cast<std::size_t>(reg.address + index * reg.size);
  return servo_bus::decode(*model_, reg, std::span(live_).subspan(at));
}

void RegisterFile::set(std::string_view name, int value) {
  const Register* reg = model_->find(name);
  if (reg == nullptr) return;
  // bus_watchdog reads -1, which no host can write.
  const bool signal = reg->writable && model_->protocol == servo_bus::Protocol::dynamixel;
  put(live_, *reg, 0, signal ? value : std::clamp(value, reg->min, reg->max));
}

void RegisterFile::write(const Register& reg, int index, int value) {
  put(live_, reg, index, value);
  if (reg.eeprom && !locked()) copy(live_, stored_, reg);
}

std::vector<const Register*> RegisterFile::write(std::size_t address,
                                                 std::span<const std::uint8_t> bytes) {
  const bool keeps = !locked();
  std::vector<const Register*> written;
  for (std::size_t i = 0; i < bytes.size() && address + i < live_.size(); ++i) {
    const Register* reg = model_->at(address + i);
    if (reg == nullptr || !reg->writable) continue;
    live_[address + i] = bytes[i];
    if (written.empty() || written.back() != reg) written.push_back(reg);
  }
  for (const Register* reg : written) {
    put(live_, *reg, 0, std::clamp(get(*reg), reg->min, reg->max));
    if (reg->eeprom && keeps) copy(live_, stored_, *reg);
  }
  return written;
}

std::vector<std::uint8_t> RegisterFile::read(std::size_t address, std::size_t length) const {
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
      put_initial(live_, reg);
    }
  }
}

void RegisterFile::restore(const Chosen& chosen) {
  for (const Register& reg : model_->registers) {
    if (!chosen(reg)) continue;
    copy(backup_, live_, reg);
    if (reg.eeprom) copy(backup_, stored_, reg);
  }
}

void RegisterFile::reset(const Chosen& chosen) {
  for (const Register& reg : model_->registers) {
    if (!chosen(reg)) continue;
    put_initial(live_, reg);
    if (reg.eeprom) put_initial(stored_, reg);
  }
}

void RegisterFile::keep(std::string_view name) {
  if (const Register* reg = model_->find(name)) copy(live_, stored_, *reg);
}

}  // namespace kaz::sim
