// Bit instructions on registers and memory bytes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/flags.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {
namespace {

enum class Bit { set, flip, clear, test, bor, bxor, band, load, store };

// Applies to one byte; true if the byte must be written back.
template <Bit op, bool inverted>
bool apply(Cpu& c, u8& byte, unsigned number) {
  const u8 mask = static_cast<u8>(1u << number);
  const u32 bit = (byte >> number & 1u) ^ (inverted ? 1u : 0u);
  switch (op) {
    case Bit::set:
      byte = static_cast<u8>(byte | mask);
      return true;
    case Bit::flip:
      byte = static_cast<u8>(byte ^ mask);
      return true;
    case Bit::clear:
      byte = static_cast<u8>(byte & ~mask);
      return true;
    case Bit::store: {
      const u32 carry = c.flags.c ^ (inverted ? 1u : 0u);
      byte = static_cast<u8>((byte & ~mask) | carry << number);
      return true;
    }
    case Bit::test:
      c.flags.z = bit;
      return false;
    case Bit::bor:
      c.flags.c |= bit;
      return false;
    case Bit::bxor:
      c.flags.c ^= bit;
      return false;
    case Bit::band:
      c.flags.c &= bit;
      return false;
    case Bit::load:
      c.flags.c = bit;
      return false;
  }
  return false;
}

template <bool from_register>
unsigned bit_number(const Cpu& c, const Insn* i) {
  return from_register ? reg<u8>(c, i->rs) & 7u : i->rs;
}

template <Bit op, bool inverted, bool from_register>
const Insn* bit_register(Cpu& c, const Insn* i) {
  u8 byte = reg<u8>(c, i->rd);
  if (apply<op, inverted>(c, byte, bit_number<from_register>(c, i))) set_reg<u8>(c, i->rd, byte);
  return i + 1;
}

template <Bit op, bool inverted, bool from_register, bool absolute>
const Insn* bit_memory(Cpu& c, const Insn* i) {
  const u32 address = absolute ? i->imm : ereg(c, i->rd);
  u8 byte = load8(c, address);
  if (apply<op, inverted>(c, byte, bit_number<from_register>(c, i))) store8(c, address, byte);
  return i + i->units;
}

// Memory forms: `w` is the nibble that distinguishes reading (C, E, 0) from writing (D, F, 8).
#define KAZ_BIT_MEMORY(op, inv, from, name, ind, abs8, abs16, second, field, text, l)              \
  {ind "n0 " second field "0", name, text ",@%n", bit_memory<op, inv, from, false>, {2, 0, 0, l}}, \
      {abs8 "aa " second field "0",                                                                \
       name,                                                                                       \
       text ",@%a",                                                                                \
       bit_memory<op, inv, from, true>,                                                            \
       {2, 0, 0, l}},                                                                              \
      {"6A1" abs16 " aaaa " second field "0",                                                      \
       name,                                                                                       \
       text ",@%a",                                                                                \
       bit_memory<op, inv, from, true>,                                                            \
       {3, 0, 0, l}},                                                                              \
  {                                                                                                \
    "6A3" abs16 " aaaa aaaa " second field "0", name, text ",@%a",                                 \
        bit_memory<op, inv, from, true>, {                                                         \
      4, 0, 0, l                                                                                   \
    }                                                                                              \
  }

#define KAZ_BIT_WRITE(op, inv, name, second, field)                              \
  {second field "s", name, "#%" field ",%s", bit_register<op, inv, false>, {1}}, \
      KAZ_BIT_MEMORY(op, inv, false, name, "7D", "7F", "8", second, field, "#%" field, 2)
#define KAZ_BIT_READ(op, inv, name, second, field)                               \
  {second field "s", name, "#%" field ",%s", bit_register<op, inv, false>, {1}}, \
      KAZ_BIT_MEMORY(op, inv, false, name, "7C", "7E", "0", second, field, "#%" field, 1)
#define KAZ_BIT_WRITE_RN(op, name, second)                          \
  {second "rs", name, "%r,%s", bit_register<op, false, true>, {1}}, \
      KAZ_BIT_MEMORY(op, false, true, name, "7D", "7F", "8", second, "r", "%r", 2)
#define KAZ_BIT_READ_RN(op, name, second)                           \
  {second "rs", name, "%r,%s", bit_register<op, false, true>, {1}}, \
      KAZ_BIT_MEMORY(op, false, true, name, "7C", "7E", "0", second, "r", "%r", 1)

const Opcode kBitRows[] = {
    KAZ_BIT_WRITE(Bit::set, false, "bset", "70", "t"),
    KAZ_BIT_WRITE(Bit::flip, false, "bnot", "71", "t"),
    KAZ_BIT_WRITE(Bit::clear, false, "bclr", "72", "t"),
    KAZ_BIT_READ(Bit::test, false, "btst", "73", "t"),
    KAZ_BIT_WRITE_RN(Bit::set, "bset", "60"),
    KAZ_BIT_WRITE_RN(Bit::flip, "bnot", "61"),
    KAZ_BIT_WRITE_RN(Bit::clear, "bclr", "62"),
    KAZ_BIT_READ_RN(Bit::test, "btst", "63"),
    KAZ_BIT_READ(Bit::bor, false, "bor", "74", "t"),
    KAZ_BIT_READ(Bit::bor, true, "bior", "74", "T"),
    KAZ_BIT_READ(Bit::bxor, false, "bxor", "75", "t"),
    KAZ_BIT_READ(Bit::bxor, true, "bixor", "75", "T"),
    KAZ_BIT_READ(Bit::band, false, "band", "76", "t"),
    KAZ_BIT_READ(Bit::band, true, "biand", "76", "T"),
    KAZ_BIT_READ(Bit::load, false, "bld", "77", "t"),
    KAZ_BIT_READ(Bit::load, true, "bild", "77", "T"),
    KAZ_BIT_WRITE(Bit::store, false, "bst", "67", "t"),
    KAZ_BIT_WRITE(Bit::store, true, "bist", "67", "T"),
};

#undef KAZ_BIT_MEMORY
#undef KAZ_BIT_WRITE
#undef KAZ_BIT_READ
#undef KAZ_BIT_WRITE_RN
#undef KAZ_BIT_READ_RN

}  // namespace

std::span<const Opcode> bit_opcodes() {
  return kBitRows;
}

}  // namespace kaz::h8s
