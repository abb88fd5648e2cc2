// The slow path of memory accesses: short RAM, registers, and what is neither.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/h8s/chip/machine.h"
#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {
namespace {

// Offset into Cpu::ram of a byte in either RAM window of the chip.
std::optional<std::uint32_t> ram_offset(const Cpu& c, std::uint32_t address) {
  const std::uint32_t offset = (address & c.mask) - c.ram_at;
  if (c.ram_size == 0) return std::nullopt;
  if (offset < kRamSize || offset - (kShortRam - kRam) < kShortRamSize) return offset;
  return std::nullopt;
}

void note_odd(Cpu& c, std::uint32_t address) {
  if (c.machine)
    c.machine->misuse(address, "word access at an odd address; the chip takes the even one below");
}

}  // namespace

void raise_fault(Cpu& c, Fault fault, std::uint32_t address) {
  if (c.fault == Fault::none) {
    c.fault = fault;
    c.fault_address = address;
    c.fault_pc = pc_of(c, c.ip);
  }
  end_stretch(c);
}

bool check_stack(Cpu& c, std::uint32_t address) {
  if (ram_offset(c, address)) return true;
  raise_fault(c, Fault::stack, address & c.mask);
  return false;
}

std::uint8_t slow_load8(Cpu& c, std::uint32_t address) {
  const auto seen = [&](std::uint8_t value) {
    if (c.observed) observe_access(c, address, 1, value, false);
    return value;
  };
  if (c.machine->is_io(address)) {
    add_stall(c, 1);
    return seen(c.machine->io_read(address));
  }
  if (const auto offset = ram_offset(c, address)) return seen(c.ram[*offset]);
  if (address < c.flash_size) {
    Machine& m = *c.machine;
    if (m.flash_control.plain()) return seen(c.flash[address]);
    return seen(m.flash_control.read(m, address, c.flash[address], m.time()));
  }
  raise_fault(c, Fault::unmapped, address);
  return 0xff;
}

std::uint16_t slow_load16(Cpu& c, std::uint32_t address) {
  if (address & 1) {
    note_odd(c, address);
    return load16(c, address - 1);
  }
  const auto seen = [&](unsigned value) {
    if (c.observed) observe_access(c, address, 2, value, false);
    return static_cast<std::uint16_t>(value);
  };
  if (const auto offset = ram_offset(c, address)) return seen(big16(c.ram + *offset));
  if (address < c.flash_size) {
    Machine& m = *c.machine;
    if (m.flash_control.plain()) return seen(big16(c.flash + address));
    const unsigned high = m.flash_control.read(m, address, c.flash[address], m.time());
    if (m.flash_control.plain()) return seen(high << 8 | c.flash[address + 1]);
    return seen(high << 8 | m.flash_control.read(m, address + 1, c.flash[address + 1], m.time()));
  }
  if (!c.machine->is_io(address)) {
    raise_fault(c, Fault::unmapped, address);
    return 0xffff;
  }
  const bool wide = c.machine->wide(address);
  add_stall(c, 1);
  const unsigned high = c.machine->io_read(address);
  if (!wide) add_stall(c, 2);
  return seen(high << 8 | c.machine->io_read(address + 1));
}

void slow_store8(Cpu& c, std::uint32_t address, std::uint8_t value) {
  if (c.machine->is_io(address)) {
    add_stall(c, 1);
    c.machine->io_write(address, value);
  } else if (const auto offset = ram_offset(c, address)) {
    c.ram[*offset] = value;
    note_ram_write(c, *offset);
  } else if (address < c.flash_size) {
    c.machine->flash_control.latch(*c.machine, address, value);
  } else {
    return raise_fault(c, Fault::unmapped, address);
  }
  if (c.observed) observe_access(c, address, 1, value, true);
}

void slow_store16(Cpu& c, std::uint32_t address, std::uint16_t value) {
  if (address & 1) {
    note_odd(c, address);
    return store16(c, address - 1, value);
  } else if (const auto offset = ram_offset(c, address)) {
    put_big16(c.ram + *offset, value);
    note_ram_write(c, *offset);
  } else if (address < c.flash_size) {
    c.machine->flash_control.latch(*c.machine, address, static_cast<std::uint8_t>(value >> 8));
    c.machine->flash_control.latch(*c.machine, address + 1, static_cast<std::uint8_t>(value));
  } else if (c.machine->is_io(address)) {
    add_stall(c, c.machine->wide(address) ? 1 : 3);
    c.machine->io_write_word(address, value);
  } else {
    return raise_fault(c, Fault::unmapped, address);
  }
  if (c.observed) observe_access(c, address, 2, value, true);
}

void mask_changed(Cpu& c, bool hold_off) {
  if (!c.machine || (c.now < c.stop && !c.machine->irq.any_unmasked(c.control, c.two_level)))
    return;
  c.hold_off = hold_off;
  end_stretch(c);
}

bool hooked_here(const Cpu& c, std::uint32_t pc) {
  return c.machine && c.machine->hooked(pc);
}

bool has_hook(const Cpu& c, std::uint32_t pc) {
  return c.machine && c.machine->hooks.contains(pc);
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
