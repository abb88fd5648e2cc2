// Functions through which instruction handlers access registers, memory and the stack.
// SPDX-License-Identifier: Apache-2.0
//
// The inline functions serve RAM and flash. If an inline function cannot serve an access, cpu/memory.cpp and
// the bus serve that access. Addresses are masked to the address width of the CPU mode. For a word at an odd
// address A, the even address A - 1 is used.
#pragma once

#include <cstring>
#include <optional>
#include <type_traits>

#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

// The slow path handles all accesses to short RAM, I/O registers, unmapped addresses, and words at odd
// addresses. The slow path also handles writes to flash, and reads of flash while flash is programmed, erased
// or verified.
std::uint8_t slow_load8(Cpu& c, std::uint32_t address);
std::uint16_t slow_load16(Cpu& c, std::uint32_t address);
void slow_store8(Cpu& c, std::uint32_t address, std::uint8_t value);
void slow_store16(Cpu& c, std::uint32_t address, std::uint16_t value);
// Discards the decoded instructions that may contain the word at `offset` (even, counted from Cpu::ram_at).
void forget_code(Cpu& c, std::uint32_t offset);
// Checks whether `address`, which the stack uses, is in RAM. If not, raises Fault::stack and returns false.
bool check_stack(Cpu& c, std::uint32_t address);

// Read and write a register or a part of a register. `offset` is the register's byte offset in Cpu::er
// (Insn::rs, Insn::rd).
template <class T>
T reg(const Cpu& c, unsigned offset) {
  T value;
  std::memcpy(&value, reinterpret_cast<const char*>(c.er.data()) + offset, sizeof value);
  return value;
}

template <class T>
void set_reg(Cpu& c, unsigned offset, T value) {
  std::memcpy(reinterpret_cast<char*>(c.er.data()) + offset, &value, sizeof value);
}

inline std::uint32_t ereg(const Cpu& c, unsigned offset) {
  return reg<std::uint32_t>(c, offset);
}

inline std::uint16_t big16(const std::uint8_t* p) {
  return static_cast<std::uint16_t>(p[0] << 8 | p[1]);
}
inline std::uint32_t big32(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(big16(p)) << 16 | big16(p + 2);
}
inline void put_big16(std::uint8_t* p, std::uint32_t value) {
  p[0] = static_cast<std::uint8_t>(value >> 8);
  p[1] = static_cast<std::uint8_t>(value);
}
inline void put_big32(std::uint8_t* p, std::uint32_t value) {
  put_big16(p, value >> 16);
  put_big16(p + 2, value);
}

// Returns the offset of `address` in Cpu::ram if the address is in one of the two RAM windows. Returns
// nullopt for other addresses, and for all addresses while RAM is off.
inline std::optional<std::uint32_t> ram_offset(const Cpu& c, std::uint32_t address) {
  const std::uint32_t offset = (address & c.mask) - c.ram_at;
  if (c.ram_size == 0) return std::nullopt;
  if (offset < kRamSize || offset - (kShortRam - kRam) < kShortRamSize) return offset;
  return std::nullopt;
}

// Must be called after each write to RAM, because the write may have changed an instruction.
inline void note_ram_write(Cpu& c, std::uint32_t offset) {
  if (c.has_code[offset / kLine]) [[unlikely]]
    forget_code(c, offset & ~1u);
}

inline std::uint8_t load8(Cpu& c, std::uint32_t address) {
  address &= c.mask;
  const std::uint32_t offset = address - c.ram_base;
  if (offset < c.ram_size) [[likely]]
    return c.ram[offset];
  if (address < c.quick_flash) return c.flash[address];
  return slow_load8(c, address);
}

inline std::uint16_t load16(Cpu& c, std::uint32_t address) {
  address &= c.mask;
  const std::uint32_t offset = address - c.ram_base;
  if (offset < c.ram_size && !(offset & 1)) [[likely]]
    return big16(c.ram + offset);
  if (address < c.quick_flash && !(address & 1)) return big16(c.flash + address);
  return slow_load16(c, address);
}

inline std::uint32_t load32(Cpu& c, std::uint32_t address) {
  address &= c.mask;
  const std::uint32_t offset = address - c.ram_base;
  if (offset + 2 < c.ram_size && offset < c.ram_size && !(offset & 1)) [[likely]]
    return big32(c.ram + offset);
  const std::uint32_t high = load16(c, address);
  return high << 16 | load16(c, address + 2);
}

inline void store8(Cpu& c, std::uint32_t address, std::uint8_t value) {
  address &= c.mask;
  const std::uint32_t offset = address - c.ram_base;
  if (offset < c.ram_size) [[likely]] {
    c.ram[offset] = value;
    note_ram_write(c, offset);
    return;
  }
  slow_store8(c, address, value);
}

inline void store16(Cpu& c, std::uint32_t address, std::uint16_t value) {
  address &= c.mask;
  const std::uint32_t offset = address - c.ram_base;
  if (offset < c.ram_size && !(offset & 1)) [[likely]] {
    put_big16(c.ram + offset, value);
    note_ram_write(c, offset);
    return;
  }
  slow_store16(c, address, value);
}

inline void store32(Cpu& c, std::uint32_t address, std::uint32_t value) {
  store16(c, address, static_cast<std::uint16_t>(value >> 16));
  store16(c, address + 2, static_cast<std::uint16_t>(value));
}

template <class T>
T load(Cpu& c, std::uint32_t address) {
  if constexpr (sizeof(T) == 1)
    return load8(c, address);
  else if constexpr (sizeof(T) == 2)
    return load16(c, address);
  else
    return load32(c, address);
}

template <class T>
void store(Cpu& c, std::uint32_t address, T value) {
  if constexpr (sizeof(T) == 1)
    store8(c, address, value);
  else if constexpr (sizeof(T) == 2)
    store16(c, address, value);
  else
    store32(c, address, value);
}

// Inline form of check_stack().
inline bool stack_ok(Cpu& c, std::uint32_t address) {
  const std::uint32_t offset = (address & c.mask) - c.ram_base;
  return offset < c.ram_size || check_stack(c, address);
}

// Push and pop a value at ER7. If ER7 is outside RAM, push and pop raise Fault::stack and access no memory,
// and pop returns 0.
template <class T>
void push(Cpu& c, T value) {
  c.er[7] -= std::uint32_t{sizeof(T)};
  if (stack_ok(c, c.er[7])) store<T>(c, c.er[7], value);
}

template <class T>
T pop(Cpu& c) {
  const std::uint32_t sp = c.er[7];
  c.er[7] += std::uint32_t{sizeof(T)};
  return stack_ok(c, sp) ? load<T>(c, sp) : T{};
}

}  // namespace kaz::h8s
