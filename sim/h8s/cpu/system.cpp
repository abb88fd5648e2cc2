// Control registers, exceptions, sleep, block moves and multiple register transfers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/flags.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {

const Insn* enter_exception(Cpu& c, const Insn* from, std::uint32_t return_pc, unsigned vector) {
  const u32 saved = ccr(c);
  if (c.normal) {
    push<u16>(c, static_cast<u16>(return_pc));
    push<u16>(c, static_cast<u16>(saved << 8 | saved));
  } else if (const u32 at = c.er[7] - 4 - c.ram_base; at + 2 < c.ram_size && at < c.ram_size &&
                                                      !(at & 1) && !c.has_code[at / kLine] &&
                                                      !c.has_code[(at + 2) / kLine]) {
    c.er[7] -= 4;
    put_big32(c.ram + at, saved << 24 | (return_pc & 0xffffff));
  } else {
    push<u16>(c, static_cast<u16>(return_pc));
    push<u16>(c, static_cast<u16>(saved << 8 | (return_pc >> 16 & 0xff)));
  }
  c.control = static_cast<u8>(c.control | 0x80 | (c.two_level ? 0x40 : 0));
  if (c.fault == Fault::stack) return from;
  if (c.normal) return jump_to(c, from, load16(c, vector * 2));
  const u32 at = vector * 4;
  return jump_to(c, from, at < c.quick_flash ? big32(c.flash + at) : load32(c, at));
}

namespace {

enum class Target { ccr, exr };

template <Target target>
void write_control(Cpu& c, u32 value) {
  if constexpr (target == Target::ccr)
    set_ccr(c, value & 0xff);
  else
    c.exr = static_cast<u8>(value | 0x78);
  mask_changed(c, true);
}

template <Target target>
u8 read_control(const Cpu& c) {
  return target == Target::ccr ? ccr(c) : c.exr;
}

enum class Change { load, bit_or, bit_xor, bit_and };

template <Target target, Change change>
const Insn* control_immediate(Cpu& c, const Insn* i) {
  const u32 old = read_control<target>(c);
  u32 value = i->imm;
  if constexpr (change == Change::bit_or) value |= old;
  if constexpr (change == Change::bit_xor) value ^= old;
  if constexpr (change == Change::bit_and) value &= old;
  write_control<target>(c, value);
  return i + i->units;
}

template <Target target>
const Insn* ldc_register(Cpu& c, const Insn* i) {
  write_control<target>(c, reg<u8>(c, i->rs));
  return i + 1;
}

template <Target target>
const Insn* stc_register(Cpu& c, const Insn* i) {
  set_reg<u8>(c, i->rd, read_control<target>(c));
  return i + 1;
}

template <Target target>
const Insn* ldc_memory(Cpu& c, const Insn* i) {
  write_control<target>(c, load16(c, ereg(c, i->rs) + i->imm) >> 8u);
  return i + i->units;
}

template <Target target>
const Insn* ldc_increment(Cpu& c, const Insn* i) {
  const u32 address = ereg(c, i->rs);
  if (i->rs == 4 * 7 && !stack_ok(c, address)) return i + i->units;
  set_reg<u32>(c, i->rs, address + 2);
  write_control<target>(c, load16(c, address) >> 8u);
  return i + i->units;
}

template <Target target>
const Insn* ldc_absolute(Cpu& c, const Insn* i) {
  write_control<target>(c, load16(c, i->imm) >> 8u);
  return i + i->units;
}

// The register is in the high byte of the word.
template <Target target>
u16 control_word(const Cpu& c) {
  const unsigned value = read_control<target>(c);
  return static_cast<u16>(value << 8 | (c.stc_copies ? value : 0u));
}

template <Target target>
const Insn* stc_memory(Cpu& c, const Insn* i) {
  store16(c, ereg(c, i->rd) + i->imm, control_word<target>(c));
  return i + i->units;
}

template <Target target>
const Insn* stc_decrement(Cpu& c, const Insn* i) {
  const u32 address = ereg(c, i->rd) - 2;
  set_reg<u32>(c, i->rd, address);
  if (i->rd == 4 * 7 && !stack_ok(c, address)) return i + i->units;
  store16(c, address, control_word<target>(c));
  return i + i->units;
}

template <Target target>
const Insn* stc_absolute(Cpu& c, const Insn* i) {
  store16(c, i->imm, control_word<target>(c));
  return i + i->units;
}

const Insn* nop(Cpu&, const Insn* i) {
  return i + 1;
}

const Insn* trapa(Cpu& c, const Insn* i) {
  return enter_exception(c, i, pc_of(c, i) + 2, 8u + i->rs);
}

const Insn* rte(Cpu& c, const Insn* i) {
  u32 high, low;
  if (const u32 at = c.er[7] - c.ram_base; at + 2 < c.ram_size && at < c.ram_size && !(at & 1)) {
    high = big16(c.ram + at);
    low = big16(c.ram + at + 2);
    c.er[7] += 4;
  } else {
    high = pop<u16>(c);
    low = c.fault == Fault::stack ? 0 : pop<u16>(c);
    if (c.fault == Fault::stack) return i + 1;
  }
  set_ccr(c, high >> 8);
  mask_changed(c, c.rte_holds_off);
  return jump_to(c, i, c.normal ? low : (high & 0xff) << 16 | low);
}

const Insn* sleep(Cpu& c, const Insn* i) {
  c.asleep = true;
  end_stretch(c);
  return i + 1;
}

// Moves one byte: two states, and those that I/O adds.
void move_byte(Cpu& c) {
  store8(c, c.er[6], load8(c, c.er[5]));
  ++c.er[5];
  ++c.er[6];
  add_stall(c, 2);
}

// Moves all at once where both places are RAM without decoded instructions, or the source is flash, and
// the destination does not follow the source within the block.
bool move_all(Cpu& c, u32 n) {
  const u32 to = (c.er[6] & c.mask) - c.ram_base;
  if (n == 0 || to >= c.ram_size || n > c.ram_size - to) return false;
  for (u32 line = to / kLine; line <= (to + n - 1) / kLine; ++line)
    if (c.has_code[line]) return false;
  const u32 address = c.er[5] & c.mask, from = address - c.ram_base;
  const u8* bytes = nullptr;
  if (from < c.ram_size && n <= c.ram_size - from)
    bytes = c.ram + from;
  else if (address < c.quick_flash && n <= c.quick_flash - address)
    bytes = c.flash + address;
  if (!bytes || (bytes < c.ram + to && bytes + n > c.ram + to)) return false;
  std::memmove(c.ram + to, bytes, n);
  c.er[5] += n;
  c.er[6] += n;
  add_stall(c, 2 * static_cast<int>(n));
  return true;
}

const Insn* eepmov_b(Cpu& c, const Insn* i) {
  if (move_all(c, c.er[4] & 0xff)) {
    c.er[4] &= ~0xffu;
    end_stretch(c);
    return i + 2;
  }
  for (u32 n = c.er[4] & 0xff; n != 0 && c.fault == Fault::none; --n) move_byte(c);
  c.er[4] &= ~0xffu;
  end_stretch(c);
  return i + 2;
}

// May be interrupted between two bytes: by an interrupt (the next instruction is stacked; the program
// must restart the move) or by an event, after which it continues.
const Insn* eepmov_w(Cpu& c, const Insn* i) {
  if (c.moving) add_stall(c, -i->states);
  c.moving = false;
  while ((c.er[4] & 0xffff) != 0 && c.fault == Fault::none) {
    if (c.now >= c.stop) {
      c.moving = true;
      --c.executed;
      end_stretch(c);
      return i;
    }
    move_byte(c);
    c.er[4] = (c.er[4] & ~0xffffu) | ((c.er[4] - 1) & 0xffff);
  }
  end_stretch(c);
  return i + 2;
}

// Flags of the old byte, then bit 7 set.
const Insn* tas(Cpu& c, const Insn* i) {
  const u32 address = ereg(c, i->rd);
  const u8 byte = flags_logic<u8>(c, load8(c, address));
  store8(c, address, static_cast<u8>(byte | 0x80));
  return i + 2;
}

template <int first, int count>
const Insn* stm(Cpu& c, const Insn* i) {
  for (u32 r = first; r < first + count && c.fault == Fault::none; ++r) push<u32>(c, c.er[r]);
  return i + 2;
}

template <int last, int count>
const Insn* ldm(Cpu& c, const Insn* i) {
  for (u32 n = 0; n < count && c.fault == Fault::none; ++n) {
    const u32 value = pop<u32>(c);
    if (c.fault == Fault::none) c.er[last - n] = value;
  }
  return i + 2;
}

#define KAZ_CONTROL(t, name, prefix, byte_prefix, x, units)                                      \
  {byte_prefix "04ii", "orc", "#%i," name, control_immediate<t, Change::bit_or>, {units}},       \
      {byte_prefix "05ii", "xorc", "#%i," name, control_immediate<t, Change::bit_xor>, {units}}, \
      {byte_prefix "06ii", "andc", "#%i," name, control_immediate<t, Change::bit_and>, {units}}, \
      {byte_prefix "07ii", "ldc", "#%i," name, control_immediate<t, Change::load>, {units}},     \
      {"03" x "r", "ldc", "%r," name, ldc_register<t>, {1}},                                     \
      {"02" x "s", "stc", name ",%s", stc_register<t>, {1}},                                     \
      {prefix " 69m0", "ldc", "@%m," name, ldc_memory<t>, {2, 0, 0, 0, 1}},                      \
      {prefix " 6Fm0 dddd", "ldc", "@(%d,%m)," name, ldc_memory<t>, {3, 0, 0, 0, 1}},            \
      {prefix " 78Y0 6B20 dddd dddd", "ldc", "@(%d,%Y)," name, ldc_memory<t>, {5, 0, 0, 0, 1}},  \
      {prefix " 6Dm0", "ldc", "@%m+," name, ldc_increment<t>, {2, 0, 0, 0, 1, 1}},               \
      {prefix " 6B00 aaaa", "ldc", "@%a," name, ldc_absolute<t>, {3, 0, 0, 0, 1}},               \
      {prefix " 6B20 aaaa aaaa", "ldc", "@%a," name, ldc_absolute<t>, {4, 0, 0, 0, 1}},          \
      {prefix " 69N0", "stc", name ",@%N", stc_memory<t>, {2, 0, 0, 0, 1}},                      \
      {prefix " 6FN0 dddd", "stc", name ",@(%d,%N)", stc_memory<t>, {3, 0, 0, 0, 1}},            \
      {prefix " 78X0 6BA0 dddd dddd", "stc", name ",@(%d,%X)", stc_memory<t>, {5, 0, 0, 0, 1}},  \
      {prefix " 6DN0", "stc", name ",@-%N", stc_decrement<t>, {2, 0, 0, 0, 1, 1}},               \
      {prefix " 6B80 aaaa", "stc", name ",@%a", stc_absolute<t>, {3, 0, 0, 0, 1}}, {             \
    prefix " 6BA0 aaaa aaaa", "stc", name ",@%a", stc_absolute<t>, {                             \
      4, 0, 0, 0, 1                                                                              \
    }                                                                                            \
  }

const Opcode kSystem[] = {
    {"0000", "nop", "", nop, {1}},
    KAZ_CONTROL(Target::ccr, "ccr", "0140", "", "0", 1),
    KAZ_CONTROL(Target::exr, "exr", "0141", "0141 ", "1", 2),
    {"57p0", "trapa", "#%p", trapa, {2, 2, 2, 0, 0, 2, true}},
    {"5670", "rte", "", rte, {2, 0, 2, 0, 0, 1, true}},
    {"0180", "sleep", "", sleep, {1, 0, 0, 0, 0, 1}},
    {"7B5C 598F", "eepmov.b", "", eepmov_b, {2, 0, 0, 2}},
    {"7BD4 598F", "eepmov.w", "", eepmov_w, {2, 0, 0, 2}},
    {"01E0 7BnC", "tas", "@%n", tas, {2, 0, 0, 2}},
    {"0110 6DF0", "stm.l", "(er0-er1),@-er7", stm<0, 2>, {2, 0, 4, 0, 0, 1, true}},
    {"0110 6DF2", "stm.l", "(er2-er3),@-er7", stm<2, 2>, {2, 0, 4, 0, 0, 1, true}},
    {"0110 6DF4", "stm.l", "(er4-er5),@-er7", stm<4, 2>, {2, 0, 4, 0, 0, 1, true}},
    {"0120 6DF0", "stm.l", "(er0-er2),@-er7", stm<0, 3>, {2, 0, 6, 0, 0, 1, true}},
    {"0120 6DF4", "stm.l", "(er4-er6),@-er7", stm<4, 3>, {2, 0, 6, 0, 0, 1, true}},
    {"0130 6DF0", "stm.l", "(er0-er3),@-er7", stm<0, 4>, {2, 0, 8, 0, 0, 1, true}},
    {"0110 6D71", "ldm.l", "@er7+,(er0-er1)", ldm<1, 2>, {2, 0, 4, 0, 0, 1, true}},
    {"0110 6D73", "ldm.l", "@er7+,(er2-er3)", ldm<3, 2>, {2, 0, 4, 0, 0, 1, true}},
    {"0110 6D75", "ldm.l", "@er7+,(er4-er5)", ldm<5, 2>, {2, 0, 4, 0, 0, 1, true}},
    {"0120 6D72", "ldm.l", "@er7+,(er0-er2)", ldm<2, 3>, {2, 0, 6, 0, 0, 1, true}},
    {"0120 6D76", "ldm.l", "@er7+,(er4-er6)", ldm<6, 3>, {2, 0, 6, 0, 0, 1, true}},
    {"0130 6D73", "ldm.l", "@er7+,(er0-er3)", ldm<3, 4>, {2, 0, 8, 0, 0, 1, true}},
};

#undef KAZ_CONTROL

}  // namespace

std::span<const Opcode> system_opcodes() {
  return kSystem;
}

}  // namespace kaz::h8s
