// Registers, memory and pattern matching of the tests' own model of the CPU.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/oracle_model_testing.h"

namespace kaz::h8s::oracle {

u8 World::ccr() const {
  return static_cast<u8>((i ? 0x80 : 0) | (ui ? 0x40 : 0) | (h ? 0x20 : 0) | (u ? 0x10 : 0) |
                         (n ? 0x08 : 0) | (z ? 0x04 : 0) | (v ? 0x02 : 0) | (c ? 0x01 : 0));
}

void World::set_ccr(u8 value) {
  i = value & 0x80;
  ui = value & 0x40;
  h = value & 0x20;
  u = value & 0x10;
  n = value & 0x08;
  z = value & 0x04;
  v = value & 0x02;
  c = value & 0x01;
}

u32 World::reg(int bits, u32 field) const {
  const u32 whole = er[field % 8];
  if (bits == 32) return whole;
  if (bits == 16) return field < 8 ? whole % 65536 : whole / 65536;
  return field < 8 ? whole / 256 % 256 : whole % 256;
}

void World::set_reg(int bits, u32 field, u32 value) {
  u32& whole = er[field % 8];
  if (bits == 32)
    whole = value;
  else if (bits == 16 && field < 8)
    whole = (whole & 0xffff0000) + (value & 0xffff);
  else if (bits == 16)
    whole = (whole & 0x0000ffff) + (value & 0xffff) * 65536;
  else if (field < 8)
    whole = (whole & 0xffff00ff) + (value & 0xff) * 256;
  else
    whole = (whole & 0xffffff00) + (value & 0xff);
}

// Words are at even addresses; bit 0 is ignored. A long word is two words, the upper one first.
u32 World::load_uncounted(int bits, u32 address) {
  if (bits == 8) return read(address & mask());
  if (bits == 32) {
    const u32 high = load_uncounted(16, address);
    return high * 65536 + load_uncounted(16, address + 2);
  }
  const u32 even = address & mask() & ~1u;
  return read(even) * 256u + read(even + 1);
}

u32 World::load(int bits, u32 address) {
  data.push_back({address & mask(), bits == 8 ? 1 : 2});
  if (bits == 32) data.push_back({(address + 2) & mask(), 2});
  return load_uncounted(bits, address);
}

void World::store(int bits, u32 address, u32 value) {
  if (bits == 32) {
    store(16, address, value / 65536);
    store(16, address + 2, value % 65536);
    return;
  }
  data.push_back({address & mask(), bits / 8});
  if (bits == 8) {
    write(address & mask(), static_cast<u8>(value));
    return;
  }
  const u32 even = address & mask() & ~1u;
  write(even, static_cast<u8>(value / 256));
  write(even + 1, static_cast<u8>(value));
}

void World::push16(u32 value) {
  er[7] -= 2;
  const u32 even = er[7] & mask() & ~1u;
  write(even, static_cast<u8>(value / 256));
  write(even + 1, static_cast<u8>(value));
}

u32 World::pop16() {
  const u32 value = load_uncounted(16, er[7]);
  er[7] += 2;
  return value;
}

void World::push_return(u32 address) {
  push16(address % 65536);
  if (!normal) push16(address / 65536 % 256);
}

Fields Form::fields(std::span<const u16> words) const {
  Fields f;
  for (std::size_t k = 0; k < bits.size(); ++k) {
    if (bits[k] < 'a') continue;
    u32& value = f.value[static_cast<std::size_t>(bits[k] - 'a')];
    value = value * 2 + (words[k / 16] >> (15 - k % 16) & 1u);
  }
  return f;
}

const std::vector<Form>& forms() {
  static const std::vector<Form> all = [] {
    std::vector<Form> list;
    list_moves(list);
    list_arithmetic(list);
    list_bits(list);
    list_control(list);
    for (Form& f : list) std::erase(f.bits, ' ');
    return list;
  }();
  return all;
}

namespace {

// The fixed bits of a form, to search faster.
struct Fixed {
  const Form* form;
  std::array<u16, 5> mask{}, value{};

  explicit Fixed(const Form& f) : form(&f) {
    for (std::size_t k = 0; k < f.bits.size(); ++k) {
      const auto bit = static_cast<u16>(0x8000 >> k % 16);
      if (f.bits[k] < 'a') mask[k / 16] |= bit;
      if (f.bits[k] == '1') value[k / 16] |= bit;
    }
  }
  bool matches(std::span<const u16> units) const {
    if (units.size() < static_cast<std::size_t>(form->units())) return false;
    for (std::size_t k = 0; k < units.size() && k < mask.size(); ++k) {
      if ((units[k] & mask[k]) != value[k]) return false;
    }
    return true;
  }
};

}  // namespace

const Form* find(std::span<const u16> units) {
  // By first byte.
  static const std::vector<std::vector<Fixed>> by_byte = [] {
    std::vector<std::vector<Fixed>> lists(256);
    for (const Form& f : forms()) {
      const Fixed fixed(f);
      for (u32 byte = 0; byte < 256; ++byte) {
        if ((byte << 8 & fixed.mask[0]) == (fixed.value[0] & 0xff00u)) lists[byte].push_back(fixed);
      }
    }
    return lists;
  }();
  for (const Fixed& fixed : by_byte[units[0] >> 8]) {
    if (fixed.matches(units)) return fixed.form;
  }
  return nullptr;
}

int step(World& w, const Form& form, std::span<const u16> units) {
  w.data.clear();
  w.block_bytes = 0;
  w.asleep = false;
  w.open_flags = 0;
  w.open_result = false;
  Fields f = form.fields(units);
  f.next = (w.pc + 2 * static_cast<u32>(form.units())) & w.mask();
  w.pc = f.next;
  form.run(w, f);
  w.pc &= w.mask() & ~1u;
  const Cycles& n = form.cycles;
  const std::size_t mode = w.normal ? 0 : 1;
  return n.i + n.j[mode] + n.k[mode] + n.l + n.m + n.n + 2 * w.block_bytes;
}

}  // namespace kaz::h8s::oracle
