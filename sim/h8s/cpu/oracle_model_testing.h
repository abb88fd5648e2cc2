// Independent model of the H8S/2000 for the tests, slow and simple, written from the manual alone.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace kaz::h8s::oracle {

using u8 = std::uint8_t;
using u16 = std::uint16_t;
using u32 = std::uint32_t;
using u64 = std::uint64_t;

// One data access of an instruction; `bytes` is 1 or 2.
struct Access {
  u32 address = 0;
  int bytes = 1;
};

// State of the model: registers, flags and access to memory.
struct World {
  std::array<u32, 8> er{};
  u32 pc = 0;
  bool i = true, ui = false, h = false, u = false, n = false, z = false, v = false, c = false;
  u8 exr = 0x7f;
  bool normal = false;  // 16-bit addresses
  // Value of Options::predecrement_stores_decremented.
  bool predecrement_stores_decremented = true;

  // Read and write one byte of memory at a masked address. The owner must set both functions.
  std::function<u8(u32)> read;
  std::function<void(u32, u8)> write;

  // Effects of the last instruction.
  std::vector<Access> data;  // accesses in the manual's columns L and M
  int block_bytes = 0;       // bytes moved by EEPMOV
  bool asleep = false;
  u8 open_flags = 0;         // CCR bits that the manual leaves undefined
  bool open_result = false;  // the destination register is undefined

  u8 ccr() const;
  void set_ccr(u8 value);
  u32 mask() const { return normal ? 0xffff : 0xffffff; }

  // Register `field` 0..15 of the given width: R0H..R7H, R0L..R7L (8 bits); R0..R7, E0..E7 (16 bits);
  // ER0..ER7 (32 bits).
  u32 reg(int bits, u32 field) const;
  void set_reg(int bits, u32 field, u32 value);

  // Data accesses, which are recorded in `data`.
  u32 load(int bits, u32 address);
  void store(int bits, u32 address, u32 value);
  // Stack and vector accesses, which are not recorded in `data`. In the manual's table, column K counts the
  // stack accesses and column J counts the vector accesses.
  u32 load_uncounted(int bits, u32 address);
  void push16(u32 value);
  u32 pop16();
  void push_return(u32 address);
};

// Values of the fields of an encoding, by letter.
struct Fields {
  std::array<u32, 26> value{};
  u32 next = 0;  // address of the next instruction
  u32 operator[](char letter) const { return value[static_cast<std::size_t>(letter - 'a')]; }
};

// Columns of the manual's table of states. J and K each have two values: element 0 is for normal mode,
// element 1 for advanced mode.
struct Cycles {
  int i = 1;
  std::array<int, 2> j{}, k{};
  int l = 0, m = 0, n = 0;
};

// One entry of the manual's instruction list.
struct Form {
  std::string name;
  // Encoding, 16 characters for each unit: 0, 1, or the lower-case letter of a field.
  std::string bits;
  std::function<void(World&, const Fields&)> run;
  Cycles cycles;

  int units() const { return static_cast<int>(bits.size() / 16); }
  Fields fields(std::span<const u16> units) const;
};

// Returns the whole instruction list.
const std::vector<Form>& forms();
// Returns the form of the instruction that begins at units[0]; null if there is no such instruction. `units`
// must not be empty.
const Form* find(std::span<const u16> units);

// Runs the instruction `units` at w.pc. Returns the duration of the instruction in states, with on-chip
// memory.
int step(World& w, const Form& form, std::span<const u16> units);

// Each of these functions appends the forms of one kind to the list. Only forms() calls these functions.
void list_moves(std::vector<Form>& to);
void list_arithmetic(std::vector<Form>& to);
void list_bits(std::vector<Form>& to);
void list_control(std::vector<Form>& to);

}  // namespace kaz::h8s::oracle
