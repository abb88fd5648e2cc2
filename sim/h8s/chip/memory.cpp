// Memory accesses outside the CPU's fast path: short RAM, I/O registers, flash under programming.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/h8s/chip/machine.h"
#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {

std::uint8_t Machine::load8(std::uint32_t address) {
  if (is_io(address) && !cpu.observed) return load_io8(address);  // nearly always
  const auto seen = [&](std::uint8_t value) {
    if (cpu.observed) notify_access(address, 1, value, false);
    return value;
  };
  if (is_io(address)) return seen(load_io8(address));
  if (const auto offset = ram_offset(cpu, address)) return seen(cpu.ram[*offset]);
  if (address < cpu.flash_size) {
    if (flash_control.plain()) return seen(cpu.flash[address]);
    return seen(flash_control.read(*this, address, cpu.flash[address], time()));
  }
  raise_fault(cpu, Fault::unmapped, address);
  return 0xff;
}

std::uint16_t Machine::load16(std::uint32_t address) {
  const auto seen = [&](unsigned value) {
    if (cpu.observed) notify_access(address, 2, value, false);
    return static_cast<std::uint16_t>(value);
  };
  if (const auto offset = ram_offset(cpu, address)) return seen(big16(cpu.ram + *offset));
  if (address < cpu.flash_size) {
    const std::uint8_t* flash = cpu.flash + address;
    if (flash_control.plain()) return seen(big16(flash));
    const unsigned high = flash_control.read(*this, address, flash[0], time());
    if (flash_control.plain()) return seen(high << 8 | flash[1]);
    return seen(high << 8 | flash_control.read(*this, address + 1, flash[1], time()));
  }
  if (!is_io(address)) {
    raise_fault(cpu, Fault::unmapped, address);
    return 0xffff;
  }
  return seen(load_io16(address));
}

void Machine::store8(std::uint32_t address, std::uint8_t value) {
  if (is_io(address) && !cpu.observed) return store_io8(address, value);  // nearly always
  if (is_io(address)) {
    store_io8(address, value);
  } else if (const auto offset = ram_offset(cpu, address)) {
    cpu.ram[*offset] = value;
    note_ram_write(cpu, *offset);
  } else if (address < cpu.flash_size) {
    flash_control.latch(*this, address, value);
  } else {
    return raise_fault(cpu, Fault::unmapped, address);
  }
  if (cpu.observed) notify_access(address, 1, value, true);
}

void Machine::store16(std::uint32_t address, std::uint16_t value) {
  if (const auto offset = ram_offset(cpu, address)) {
    put_big16(cpu.ram + *offset, value);
    note_ram_write(cpu, *offset);
  } else if (address < cpu.flash_size) {
    flash_control.latch(*this, address, static_cast<std::uint8_t>(value >> 8));
    flash_control.latch(*this, address + 1, static_cast<std::uint8_t>(value));
  } else if (is_io(address)) {
    store_io16(address, value);
  } else {
    return raise_fault(cpu, Fault::unmapped, address);
  }
  if (cpu.observed) notify_access(address, 2, value, true);
}

void Machine::odd_word_access(std::uint32_t address) {
  misuse(address, "word access at an odd address; the chip uses the even address below");
}

std::uint8_t* Machine::memory_at(std::uint32_t address) {
  address &= cpu.mask;
  if (address < cpu.flash_size) return flash_.data() + address;
  const std::uint32_t offset = address - (cpu.mask & kBlock);
  if (offset - kRam < kRamSize || offset - kShortRam < kShortRamSize) return block_.data() + offset;
  return nullptr;
}

const std::uint8_t* Machine::memory_at(std::uint32_t address) const {
  return const_cast<Machine*>(this)->memory_at(address);
}

void Machine::forget_flash(std::uint32_t address, std::uint32_t size) {
  const std::uint32_t first = address / 2 > kMaxUnits ? address / 2 - kMaxUnits : 0;
  const std::uint32_t end = std::min((address + size + 1) / 2, cpu.flash_size / 2);
  for (std::uint32_t k = first; k < end; ++k) cpu.code[kFlashCode + k].run = nullptr;
  if (translator_ && first < end) translator_->forget(kFlashCode + first, end - first);
}

void Machine::forget_code_at(std::uint32_t address) {
  address &= cpu.mask;
  if (address < cpu.flash_size) {
    forget_flash(address, 1);
  } else {
    forget_code(cpu, (address - cpu.ram_at) & ~1u);
  }
}

void Machine::set_ram_enabled(bool on) {
  const std::uint32_t size = on ? kRamSize : 0;
  if (cpu.ram_size == size) return;
  cpu.ram_size = size;
  for (std::uint32_t k = kRamCode; k < kCodeSize; ++k) cpu.code[k].run = nullptr;
  if (translator_) translator_->forget_all();
}

}  // namespace kaz::h8s
