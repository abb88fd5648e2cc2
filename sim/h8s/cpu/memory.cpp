// The slow path of memory accesses, faults, and queries of the bus.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/access.h"

namespace kaz::h8s {

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
  return c.bus->load8(address);
}

std::uint16_t slow_load16(Cpu& c, std::uint32_t address) {
  if (!(address & 1)) return c.bus->load16(address);
  if (c.bus) c.bus->odd_word_access(address);
  return load16(c, address - 1);
}

void slow_store8(Cpu& c, std::uint32_t address, std::uint8_t value) {
  c.bus->store8(address, value);
}

void slow_store16(Cpu& c, std::uint32_t address, std::uint16_t value) {
  if (!(address & 1)) return c.bus->store16(address, value);
  if (c.bus) c.bus->odd_word_access(address);
  store16(c, address - 1, value);
}

void mask_changed(Cpu& c, bool hold_off) {
  if (!c.bus || (c.now < c.stop && !c.bus->interrupt_pending())) return;
  c.hold_off = hold_off;
  end_stretch(c);
}

bool hooked_here(const Cpu& c, std::uint32_t pc) {
  return c.bus && c.bus->hook_due(pc);
}

bool has_hook(const Cpu& c, std::uint32_t pc) {
  return c.bus && c.bus->has_hook(pc);
}

}  // namespace kaz::h8s
