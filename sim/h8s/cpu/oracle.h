// An independent model of the H8S/2000 for the tests: slow, plain, written from the manual alone.
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

// One access to data by an instruction; of two or one bytes.
struct Access {
  u32 address = 0;
  int bytes = 1;
};

// Registers, flags and memory of the model.
struct World {
  std::array<u32, 8> er{};
  u32 pc = 0;
  bool i = true, ui = false, h = false, u = false, n = false, z = false, v = false, c = false;
  u8 exr = 0x7f;
  bool normal = false;  // 16-bit addresses
  // Options::predecrement_stores_decremented.
  bool predecrement_stores_decremented = true;

  std::function<u8(u32)> read;
  std::function<void(u32, u8)> write;

  // Effects of the last instruction.
  std::vector<Access> data;  // accesses that the manual counts as L or M
  int block_bytes = 0;       // moved by EEPMOV
  bool asleep = false;
  u8 open_flags = 0;         // CCR bits that the manual leaves undefined
  bool open_result = false;  // the destination register is undefined

  u8 ccr() const;
  void set_ccr(u8 value);
  u32 mask() const { return normal ? 0xffff : 0xffffff; }

  // 8: R0H..R7H, R0L..R7L; 16: R0..R7, E0..E7; 32: ER0..ER7.
  u32 reg(int bits, u32 field) const;
  void set_reg(int bits, u32 field, u32 value);

  u32 load(int bits, u32 address);
  void store(int bits, u32 address, u32 value);
  // Stack and vector accesses: counted as K and J, which are in the table.
  u32 load_uncounted(int bits, u32 address);
  void push16(u32 value);
  u32 pop16();
  void push_return(u32 address);
};

// Values of the lettered fields of a pattern.
struct Fields {
  std::array<u32, 26> value{};
  u32 next = 0;  // address behind the instruction
  u32 operator[](char letter) const { return value[static_cast<std::size_t>(letter - 'a')]; }
};

// Columns of the manual's table of cycles. J and K: normal mode, advanced mode.
struct Cycles {
  int i = 1;
  std::array<int, 2> j{}, k{};
  int l = 0, m = 0, n = 0;
};

// One line of the instruction list: bits of the encoding, lower-case letters for fields.
struct Form {
  std::string name;
  std::string bits;  // without spaces, 16 a unit
  std::function<void(World&, const Fields&)> run;
  Cycles cycles;

  int units() const { return static_cast<int>(bits.size() / 16); }
  Fields fields(std::span<const u16> units) const;
};

// The whole instruction list.
const std::vector<Form>& forms();
// Null when the units encode no instruction.
const Form* find(std::span<const u16> units);

// Runs the instruction whose units these are, at w.pc. Returns its states with all accesses on chip
// memory.
int step(World& w, const Form& form, std::span<const u16> units);

// Lists of forms by kind, for forms().
void list_moves(std::vector<Form>& to);
void list_arithmetic(std::vector<Form>& to);
void list_bits(std::vector<Form>& to);
void list_control(std::vector<Form>& to);

}  // namespace kaz::h8s::oracle
