// Decoding: from 16-bit units of memory to handlers with their operands.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {

Handler near_branch(Handler far);

namespace {

// A pattern without its spaces.
struct Row {
  const Opcode* opcode;
  std::array<char, 4 * kMaxUnits> nibbles;
  int count;
};

bool is_literal(char ch) {
  return (ch >= '0' && ch <= '9') || (ch >= 'A' && ch <= 'F');
}

unsigned literal(char ch) {
  return static_cast<unsigned>(ch <= '9' ? ch - '0' : ch - 'A' + 10);
}

// Whether a nibble matches a pattern character.
bool fits(char ch, unsigned nibble) {
  if (is_literal(ch)) return literal(ch) == nibble;
  switch (ch) {
    case 'm':
    case 'n':
    case 't':
      return nibble < 8;
    case 'M':
    case 'N':
    case 'T':
      return nibble >= 8;
    case 'p':
      return nibble < 4;
    default:
      return true;
  }
}

// Rows indexed by the first byte that they can match.
struct Table {
  std::vector<Row> rows;
  std::array<std::vector<std::uint16_t>, 256> by_byte;

  Table() {
    for (auto group : {move_opcodes(), arithmetic_opcodes(), shift_opcodes(), bit_opcodes(),
                       branch_opcodes(), system_opcodes()}) {
      for (const Opcode& opcode : group) add(opcode);
    }
  }

  void add(const Opcode& opcode) {
    Row row{&opcode, {}, 0};
    for (const char* p = opcode.pattern; *p; ++p) {
      if (*p != ' ') row.nibbles[static_cast<std::size_t>(row.count++)] = *p;
    }
    for (unsigned byte = 0; byte < 256; ++byte) {
      if (fits(row.nibbles[0], byte >> 4) && fits(row.nibbles[1], byte & 15))
        by_byte[byte].push_back(static_cast<std::uint16_t>(rows.size()));
    }
    rows.push_back(row);
  }
};

const Table& table() {
  static const Table instance;
  return instance;
}

// Offsets of byte and word registers inside the 32-bit register file of the host.
std::uint8_t byte_offset(unsigned field) {
  const bool low = field >= 8;
  const unsigned base = 4 * (field & 7);
  if constexpr (std::endian::native == std::endian::little)
    return static_cast<std::uint8_t>(base + (low ? 0 : 1));
  else
    return static_cast<std::uint8_t>(base + (low ? 3 : 2));
}

std::uint8_t word_offset(unsigned field) {
  const bool upper = field >= 8;
  const unsigned base = 4 * (field & 7);
  constexpr bool little = std::endian::native == std::endian::little;
  return static_cast<std::uint8_t>(base + (upper == little ? 2 : 0));
}

std::uint32_t sign_extend(std::uint32_t value, int bits) {
  if (bits >= 32) return value;
  const std::uint32_t sign = 1u << (bits - 1);
  return (value ^ sign) - sign;
}

void take_field(Insn& insn, char ch, unsigned nibble) {
  switch (ch) {
    case 'r':
      insn.rs = byte_offset(nibble);
      break;
    case 's':
      insn.rd = byte_offset(nibble);
      break;
    case 'u':
      insn.rs = word_offset(nibble);
      break;
    case 'w':
      insn.rd = word_offset(nibble);
      break;
    case 'm':
    case 'M':
    case 'Y':
      insn.rs = static_cast<std::uint8_t>(4 * (nibble & 7));
      break;
    case 'n':
    case 'N':
    case 'X':
      insn.rd = static_cast<std::uint8_t>(4 * (nibble & 7));
      break;
    case 't':
    case 'T':
      insn.rs = static_cast<std::uint8_t>(nibble & 7);
      break;
    case 'p':
      insn.rs = static_cast<std::uint8_t>(nibble);
      break;
    default:
      break;
  }
}

std::uint32_t extend(char kind, std::uint32_t value, int bits) {
  if (kind == 'd' || kind == 'j') return sign_extend(value, bits);
  if (kind == 'a' && bits == 8) return 0xffff00 | value;
  if (kind == 'a' && bits == 16) return sign_extend(value, 16) & 0xffffff;
  return value;
}

}  // namespace

Decoded decode(std::span<const std::uint16_t> units, bool normal) {
  if (units.empty()) return {};
  for (std::uint16_t index : table().by_byte[units[0] >> 8]) {
    const Row& row = table().rows[index];
    if (static_cast<std::size_t>(row.count) > 4 * units.size()) continue;
    Decoded result;
    std::uint32_t value = 0;
    int bits = 0;
    char kind = 0;
    bool match = true;
    for (int k = 0; k < row.count && match; ++k) {
      const char ch = row.nibbles[static_cast<std::size_t>(k)];
      const unsigned nibble = units[static_cast<std::size_t>(k / 4)] >> (12 - 4 * (k % 4)) & 15u;
      match = fits(ch, nibble);
      if (ch == 'i' || ch == 'a' || ch == 'd' || ch == 'j' || ch == 'v') {
        value = value << 4 | nibble;
        bits += 4;
        kind = ch;
      } else {
        take_field(result.insn, ch, nibble);
      }
    }
    if (!match) continue;
    const Counts& n = row.opcode->counts;
    const int j = normal ? n.j / 2 : n.j, k = normal && !n.k_fixed ? n.k / 2 : n.k;
    result.opcode = row.opcode;
    result.insn.run = row.opcode->run;
    result.insn.imm = extend(kind, value, bits);
    result.insn.units = static_cast<std::uint8_t>(row.count / 4);
    result.insn.states = static_cast<std::uint8_t>(n.i + j + k + n.l + n.m + n.n);
    return result;
  }
  return {};
}

namespace {

const Insn* undefined(Cpu& c, const Insn* i) {
  raise_fault(c, Fault::undefined, pc_of(c, i));
  return i;
}

const Insn* fetch_outside(Cpu& c, const Insn* i) {
  raise_fault(c, Fault::fetch, pc_of(c, i));
  return i;
}

// Handler of an instruction with a code hook: takes no time, leaves the inner loop.
const Insn* announce(Cpu& c, const Insn* i) {
  --c.executed;
  end_stretch(c);
  return i;
}

// A memory region for decoding: its bytes from `address` on.
struct Stretch {
  const std::uint8_t* bytes;
  std::uint32_t units;                 // from the address to the end
  std::uint32_t first_code, end_code;  // of the stretch in Cpu::code
};

Stretch stretch_of(const Cpu& c, std::uint32_t index) {
  if (index < c.ram_code) {
    const std::uint32_t end = c.flash_size / 2;
    return {c.flash + 2 * index, index < end ? end - index : 0, kFlashCode, end};
  }
  if (index < c.short_ram_code) {
    const std::uint32_t end = c.ram_code + c.ram_size / 2;
    return {c.ram + 2 * (index - c.ram_code), index < end ? end - index : 0, c.ram_code, end};
  }
  const std::uint32_t end = kShortRamCode + (c.ram_size ? kShortRamSize / 2 : 0);
  return {c.ram + kShortRam - kRam + 2 * (index - kShortRamCode), index < end ? end - index : 0,
          kShortRamCode, end};
}

// The flat machine's memory wraps: its top is followed by its beginning.
const Insn* wrap(Cpu& c, const Insn* i) {
  --c.executed;
  return at_address(c, pc_of(c, i));
}

const Insn* odd_pc(Cpu& c, const Insn* i) {
  raise_fault(c, Fault::odd_pc, pc_of(c, i));
  return i;
}

// A semihosting request instead of a subroutine call; the caller of run_stretch handles it.
const Insn* host_request(Cpu& c, const Insn* i) {
  c.request = static_cast<std::uint8_t>(i->imm);
  end_stretch(c);
  return i + 1;
}

bool is_host_request(const Cpu& c, std::uint16_t unit) {
  return c.semihost && unit >= 0x5fc5 && unit <= 0x5fcc;
}

}  // namespace

namespace {

Decoded decode_stretch(const Cpu& c, const Stretch& stretch) {
  std::array<std::uint16_t, kMaxUnits> units{};
  std::size_t available = std::min<std::size_t>(stretch.units, kMaxUnits);
  for (std::size_t k = 0; k < available; ++k) units[k] = big16(stretch.bytes + 2 * k);
  for (std::size_t k = 0; c.flat && available < kMaxUnits; ++k)
    units[available++] = big16(c.ram + 2 * k);
  return decode(std::span(units).first(available), c.normal);
}

// Fetches and decodes into the slot; returns the memory region.
Stretch decode_slot(Cpu& c, Insn& slot, std::uint32_t index) {
  const Stretch stretch = stretch_of(c, index);
  if (stretch.units == 0) {
    slot = {c.flat ? wrap : fetch_outside, 0, 0, 0, 0, 1};
    return stretch;
  }
  const Decoded decoded = decode_stretch(c, stretch);
  slot = decoded.opcode ? decoded.insn : Insn{undefined, big16(stretch.bytes), 0, 0, 0, 1};
  const std::uint16_t first = big16(stretch.bytes);
  if (is_host_request(c, first)) {
    slot.run = host_request;
    slot.imm = first & 0xff;
  }
  return stretch;
}

}  // namespace

Decoded decode_at(const Cpu& c, std::uint32_t index) {
  const Stretch stretch = stretch_of(c, index);
  return stretch.units == 0 ? Decoded{} : decode_stretch(c, stretch);
}

Handler decode_afresh(Cpu& c, const Insn* ip) {
  if (ip == &c.outside) return ip->run;
  const auto index = static_cast<std::uint32_t>(ip - c.code);
  Insn& slot = c.code[index];
  decode_slot(c, slot, index);
  if (c.hooks && hooked_here(c, pc_of(c, ip))) slot = {announce, 0, 0, 0, 0, slot.units};
  return slot.run;
}

void note_code_in_ram(Cpu& c) {
  if (c.code_in_ram) return;
  c.code_in_ram = true;
  if (c.translated) c.translated->forget_all();
}

Handler decode_in_place(Cpu& c, const Insn* ip) {
  const auto index = static_cast<std::uint32_t>(ip - c.code);
  Insn& slot = c.code[index];
  const Stretch stretch = decode_slot(c, slot, index);
  if (stretch.units == 0) return slot.run;
  if (const Handler near = near_branch(slot.run)) {
    const std::int64_t to =
        static_cast<std::int64_t>(index) + slot.units + (static_cast<std::int32_t>(slot.imm) >> 1);
    if (!(slot.imm & 1) && to >= stretch.first_code && to < stretch.end_code) {
      slot.run = near;
      slot.imm = static_cast<std::uint32_t>(to - index);
    }
  }
  if (index >= c.ram_code) {
    note_code_in_ram(c);
    const std::uint32_t offset = static_cast<std::uint32_t>(stretch.bytes - c.ram);
    const std::uint32_t last = offset + 2 * std::min<std::uint32_t>(kMaxUnits, stretch.units) - 1;
    c.has_code[offset / kLine] = c.has_code[last / kLine] = 1;
    if (c.flat && stretch.units < kMaxUnits) c.has_code[0] = 1;
  }
  if (c.hooks && hooked_here(c, pc_of(c, ip))) slot = {announce, 0, 0, 0, 0, slot.units};
  return slot.run;
}

void forget_code(Cpu& c, std::uint32_t offset) {
  const bool low = c.flat || offset < kShortRam - kRam;
  const std::uint32_t base = low ? c.ram_code : kShortRamCode;
  const std::uint32_t at = (low ? offset : offset - (kShortRam - kRam)) / 2;
  for (std::uint32_t back = 0; back < kMaxUnits; ++back) {
    if (back <= at)
      c.code[base + at - back].run = nullptr;
    else if (c.flat)
      c.code[base + at + c.ram_size / 2 - back].run = nullptr;
  }
  if (c.translated) c.translated->forget(base + at, 1);
}

const Insn* at_address(Cpu& c, std::uint32_t address) {
  if ((address & 1) && c.flat) [[unlikely]] {
    c.outside = {odd_pc, address & c.mask, 0, 0, 0, 1};
    return &c.outside;
  }
  address &= c.mask & ~1u;
  if (address < c.flash_size) return c.code + kFlashCode + address / 2;
  const std::uint32_t offset = address - c.ram_at;
  if (offset < c.ram_size) return c.code + c.ram_code + offset / 2;
  if (c.ram_size != 0 && offset - (kShortRam - kRam) < kShortRamSize)
    return c.code + kShortRamCode + (offset - (kShortRam - kRam)) / 2;
  c.outside = {fetch_outside, address, 0, 0, 0, 1};
  return &c.outside;
}

}  // namespace kaz::h8s
