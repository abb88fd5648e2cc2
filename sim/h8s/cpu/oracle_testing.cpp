// Chip and model side by side.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/oracle_testing.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace kaz::h8s::oracle {
namespace {

constexpr u32 kBase = 0xffe000;
constexpr u32 kData = 0xffe400, kDataSize = 0x800;  // of the data that instructions work on
constexpr u32 kStackArea = 0xffed00;

// Registers that return the value written: port pull-ups (8-bit bus), timer compare registers
// (16-bit bus).
constexpr u32 kNarrow = 0xffffac, kWide = 0xffffcc;

bool has(const Form& form, const char* part) {
  return form.name.find(part) != std::string::npos;
}

bool moves_pointer(const Form& form) {
  return has(form, "@-ERn");
}
bool uses_pointer(const Form& form) {
  return has(form, "@ERn") || has(form, "@(d") || has(form, "@ERd") || form.name == "tas";
}
char pointer_letter(const Form& form) {
  return has(form, "@ERd") ? 'd' : 'r';
}
int operand_bytes(const Form& form) {
  const bool word = has(form, "ldc") || has(form, "stc") || has(form, ".w");
  return has(form, ".l") ? 4 : word ? 2 : 1;
}
bool jumps(const Form& form) {
  return has(form, "jmp") || has(form, "jsr");
}

std::string hex(u32 value) {
  char text[16];
  std::snprintf(text, sizeof text, "%x", value);
  return text;
}

// " pc is 1002 not 1004"
std::string differ(const char* what, u32 where, u32 got, u32 wanted) {
  char text[96];
  std::snprintf(text, sizeof text, " %s %x is %x not %x", what, where, got, wanted);
  return text;
}

}  // namespace

std::vector<u16> encode(const Form& form, const Fields& fields) {
  std::vector<u16> units(static_cast<std::size_t>(form.units()));
  std::array<u32, 26> left{};
  for (const char ch : form.bits) {
    if (ch >= 'a') ++left[static_cast<std::size_t>(ch - 'a')];
  }
  for (std::size_t k = 0; k < form.bits.size(); ++k) {
    const char ch = form.bits[k];
    u32 bit = ch == '1';
    if (ch >= 'a') bit = fields[ch] >> --left[static_cast<std::size_t>(ch - 'a')] & 1;
    units[k / 16] = static_cast<u16>(units[k / 16] * 2 + bit);
  }
  return units;
}

Bench::Bench(bool normal, const Options& options)
    : chip([&] {
        Options o = options;
        o.mode = normal ? 3 : 2;
        return o;
      }()),
      flash_(normal ? 0xe000 : 0x20000),
      ram_(0x2000) {
  Image image;
  Segment all{0, 0, "all", {}};
  for (u8& byte : flash_) byte = static_cast<u8>(random());
  all.bytes = flash_;
  image.segments.push_back(all);
  (void)chip.load(image);
  chip.power_on();
  world.normal = normal;
  world.predecrement_stores_decremented = options.predecrement_stores_decremented;
  world.read = [this](u32 a) { return model_read(a); };
  world.write = [this](u32 a, u8 v) { model_write(a, v); };
  for (u32 at = 0; at < 0x2000; ++at) {
    const u8 value = static_cast<u8>(random());
    if (chip.poke(kBase + at, value)) ram_[at] = value;
  }
  // All modules on, by a program: mov.w r0,@MSTPCR.
  Registers r = chip.registers();
  r.er = {};
  r.pc = kRamCode;
  for (const u32 k : {0x6bu, 0x80u, 0xffu, 0x86u}) chip.poke(r.pc++, static_cast<u8>(k));
  r.pc = kRamCode;
  chip.set_registers(r);
  chip.step();
  for (u32 k = 0; k < 4; ++k) ram_[kRamCode - kBase + k] = *chip.peek(kRamCode + k);
}

u8 Bench::model_read(u32 address) {
  if (address < flash_.size()) return flash_[address];
  const u32 a = address | (world.normal ? 0xff0000 : 0);
  if (a - 0xffe080 < 0xf80 || a - 0xffff00 < 0x80) return ram_[a - kBase];
  if (io_.contains(a)) return io_[a];
  outside_.append(" the model reads ").append(hex(a));
  return 0;
}

void Bench::model_write(u32 address, u8 value) {
  const u32 a = address | (world.normal ? 0xff0000 : 0);
  if (a - 0xffe080 < 0xf80 || a - 0xffff00 < 0x80)
    ram_[a - kBase] = value;
  else if (io_.contains(a))
    io_[a] = value;
  else
    outside_.append(" the model writes ").append(hex(a));
}

// A byte access to a register takes one state more than one to memory; a word three more on the
// 8-bit bus, one on the 16-bit bus.
int Bench::io_states(const Access& a) const {
  const u32 at = a.address | (world.normal ? 0xff0000 : 0);
  if (at < 0xffff80) return 0;
  if (a.bytes == 1) return 1;
  return at >= kWide && at < kWide + 4 ? 1 : 3;
}

std::string Bench::trial(const Form& form, const std::vector<u16>& units, const World& before,
                         u32 at) {
  if (code_at_ != at || code_ != units) {
    put(at, units);
    code_at_ = at;
    code_ = units;
  }
  World& w = world;
  w.er = before.er;
  w.set_ccr(before.ccr());
  w.exr = before.exr;
  w.pc = at & w.mask();
  outside();

  chip.set_registers({w.er, w.pc, w.ccr(), w.exr});
  const States start = chip.now();
  Stop stop = chip.step();
  // A block move of words' count may stop between two bytes.
  while (form.name == "eepmov.w" && stop.reason == Stop::Reason::reached &&
         chip.registers().pc == w.pc)
    stop = chip.step();

  int states = step(w, form, units);
  for (const Access& a : w.data) states += io_states(a);

  std::string wrong = outside();
  if (stop.reason != Stop::Reason::reached) wrong.append(" stopped: ").append(stop.report);
  wrong += compare(w.data, w.open_flags, w.open_result);
  const auto took = static_cast<u32>(chip.now() - start);
  if (took != static_cast<u32>(states))
    wrong += differ("states", 0, took, static_cast<u32>(states));
  if (wrong.empty()) return {};
  std::string text = form.name;
  text.append(" [");
  for (const u16 unit : units) text.append(" ").append(hex(unit));
  text.append(" ] er");
  for (const u32 er : before.er) text.append(" ").append(hex(er));
  return text.append(" ccr ").append(hex(before.ccr())).append(":").append(wrong);
}

std::string Bench::compare(std::span<const Access> accesses, u8 open_flags, bool open_result) {
  World& w = world;
  std::string wrong;
  const Registers r = chip.registers();
  for (u32 n = 0; n < 8; ++n) {
    if (r.er[n] == w.er[n]) continue;
    // Results that the manual leaves open are copied from the chip.
    if (!open_result) wrong += differ("er", n, r.er[n], w.er[n]);
    w.er[n] = r.er[n];
  }
  if (r.pc != w.pc) wrong += differ("pc", 0, r.pc, w.pc);
  if ((r.ccr ^ w.ccr()) & ~open_flags) wrong += differ("ccr", 0, r.ccr, w.ccr());
  if (r.exr != w.exr) wrong += differ("exr", 0, r.exr, w.exr);
  if (chip.asleep() != w.asleep) wrong += differ("asleep", 0, chip.asleep(), w.asleep);
  for (const Access& a : accesses) {
    for (u32 k = 0; k < static_cast<u32>(a.bytes); ++k) {
      const u32 place = (a.bytes == 2 ? a.address & ~1u : a.address) + k;
      const u32 got = chip.peek(place).value_or(0), wanted = model_read(place);
      if (got != wanted) wrong += differ("memory", place, got, wanted);
    }
  }
  return wrong;
}

// Any number, or one at a border of its 8, 16 or 32 bits.
u32 Bench::border(u32 bits) {
  static constexpr std::array<u32, 16> kBorders = {
      0,      1,      2,      0x7f,   0x80,   0xff,   0x0f,       0x10,
      0x7fff, 0x8000, 0xffff, 0x0fff, 0x1000, 0xf000, 0x7fffffff, 0x80000000};
  const u32 value = random();
  switch (random() % 4) {
    case 0:
      return kBorders[value % kBorders.size()];
    case 1:
      return ~kBorders[value % kBorders.size()];
    case 2:
      return (kBorders[value % kBorders.size()] << 16) + kBorders[value / 16 % kBorders.size()];
    default:
      return bits == 32 ? value : value >> (32 - bits);
  }
}

u32 Bench::data_address(const Form& form, bool io, bool in_ram) {
  const int bytes = operand_bytes(form);
  if (io) return random() % 2 && bytes < 4 ? kNarrow : kWide;
  const bool reads_only = has(form, "mov") && has(form, ",Rd");
  if (!in_ram && reads_only && random() % 4 == 0)
    return static_cast<u32>(0x4000 + random() % 0x4000) & (bytes == 1 ? ~0u : ~1u);
  const u32 at = kData + random() % (kDataSize - 8);
  // Odd addresses of words now and then: bit 0 is ignored.
  return bytes == 1 || random() % 16 == 0 ? at : at & ~1u;
}

// Where a jump may lead; odd now and then.
u32 Bench::landing() {
  if (landings.empty() || random() % 4 == 0) return static_cast<u32>(random());
  const u32 at = landings[random() % landings.size()];
  return random() % 16 == 0 ? at | 1 : at;
}

// Fields that hold an address: one that has memory. Address registers: not the stack pointer where
// the access would end with "stack outside RAM".
void Bench::aim_fields(const Form& form, Fields& f, bool io) {
  const auto field = [&](char ch) -> u32& { return f.value[static_cast<std::size_t>(ch - 'a')]; };
  const u32 target = data_address(form, io, false);
  const u32 garbage = static_cast<u32>(random()) & (world.normal ? 0xffff0000 : 0xff000000);
  if (has(form, "@aa:8")) {
    // The vectors of JMP and JSR are at the beginning of memory, and each points to a landing, if any.
    const bool vectors = jumps(form), whole = !landings.empty() && random() % 4 != 0;
    field('a') = vectors ? static_cast<u32>(whole ? random() % 64 * 4 : random() % 128 * 2)
                 : io    ? target % 256
                         : static_cast<u32>(random() % 0x80);
  } else if (has(form, "@aa:16")) {
    field('a') = target % 65536;
    if (target >= 0x8000 && target < 0xff8000) field('a') = kData % 65536;
  } else if (has(form, "@aa:32")) {
    field('a') = (target & world.mask()) | garbage;
  } else if (has(form, "@aa:24")) {
    if (!landings.empty()) field('a') = landing() & 0xffffff;
  } else if (uses_pointer(form) && moves_pointer(form) && io && field('r') == 7) {
    field('r') = static_cast<u32>(random() % 7);
  }
}

// Address registers for these fields, and what the stack holds for RTS and RTE.
void Bench::aim_registers(const Form& form, const Fields& f, World& before, bool io) {
  const u32 garbage = static_cast<u32>(random()) & (world.normal ? 0xffff0000 : 0xff000000);
  before.er[7] = (kStackArea + random() % 0x100 * 2) & 0xffffff;
  if (random() % 32 == 0) ++before.er[7];  // words are at the even addresses below
  if (random() % 2) before.er[7] = (before.er[7] & world.mask()) | garbage;
  if (has(form, "eepmov")) {
    before.er[4] = (before.er[4] & ~0xffffu) | random() % 24;
    before.er[5] = (data_address(form, io, false) & world.mask()) | garbage;
    before.er[6] = (kData + random() % (kDataSize - 32)) & (world.mask() | garbage);
  } else if ((form.name == "rts" || form.name == "rte") && !landings.empty()) {
    const u32 to = landing(), at = (before.er[7] | (world.normal ? 0xff0000 : 0)) & 0xfffffe;
    const auto high = static_cast<u8>(random());
    const u8 bytes[] = {high, static_cast<u8>(to >> 16), static_cast<u8>(to >> 8),
                        static_cast<u8>(to)};
    put(at, std::span<const u8>(bytes));
  } else if (jumps(form)) {
    if (uses_pointer(form) && !landings.empty() && f['r'] != 7) before.er[f['r']] = landing();
  } else if (uses_pointer(form)) {
    const u32 pointer = f[pointer_letter(form)];
    const bool moves = moves_pointer(form), store = has(form, ",@");
    const u32 target = data_address(form, io, moves && pointer == 7);
    u32 at = target;
    if (has(form, "d:16")) at -= f['o'] < 0x8000 ? f['o'] : f['o'] + 0xffff0000;
    if (has(form, "d:32")) at -= f['o'];
    if (moves && store) at += static_cast<u32>(operand_bytes(form));
    before.er[pointer] = (at & world.mask()) | garbage;
  }
}

void Bench::read_io() {
  for (u32 k = 0; k < 4; ++k) {
    for (const u32 base : {kNarrow, kWide}) {
      if (const auto now = chip.peek(base + k); now && (k < 2 || base == kWide))
        io_[base + k] = *now;
    }
  }
}

void Bench::put(u32 address, std::span<const u8> bytes) {
  for (const u8 byte : bytes) {
    chip.poke(address, byte);
    if (address < flash_.size())
      flash_[address] = byte;
    else
      ram_[address - kBase] = byte;
    ++address;
  }
}

void Bench::put(u32 address, const std::vector<u16>& units) {
  std::vector<u8> bytes;
  for (const u16 unit : units) {
    bytes.push_back(static_cast<u8>(unit >> 8));
    bytes.push_back(static_cast<u8>(unit));
  }
  put(address, bytes);
}

std::vector<u16> Pin::apply(std::vector<u16> units) const {
  for (std::size_t k = 0; k < units.size(); ++k)
    units[k] = static_cast<u16>((units[k] & ~mask[k]) | value[k]);
  return units;
}

std::vector<u16> Bench::draw_units(const Form& form, bool io, const Pin& pin) {
  Fields f;
  for (std::size_t n = 0; n < f.value.size(); ++n) {
    const auto width = static_cast<u32>(
        std::count(form.bits.begin(), form.bits.end(), static_cast<char>('a' + n)));
    if (width != 0) f.value[n] = border(width) & (width == 32 ? ~0u : (1u << width) - 1);
  }
  aim_fields(form, f, io);
  return pin.apply(encode(form, f));
}

World Bench::draw_registers(const Form& form, const std::vector<u16>& units, bool io) {
  World before;
  for (u32& er : before.er) er = border(32);
  before.set_ccr(static_cast<u8>(random() | 0x80));
  before.exr = static_cast<u8>(random() | 0x78);
  aim_registers(form, form.fields(units), before, io);
  return before;
}

std::string Bench::random_trial(const Form& form, bool io) {
  const std::vector<u16> units = draw_units(form, io);
  const World before = draw_registers(form, units, io);
  if (io) read_io();
  const u32 at = world.mask() & (random() % 2 ? kFlashCode : kRamCode);
  return trial(form, units, before, at < 0x20000 && at == kFlashCode ? at : kRamCode);
}

std::string Bench::compare_memory() {
  for (u32 at = 0; at < 0x2000; ++at) {
    const u32 a = kBase + at;
    if (!(a - 0xffe080 < 0xf80 || a - 0xffff00 < 0x80)) continue;
    const u32 got = chip.peek(a).value_or(0);
    if (got != ram_[at]) return differ("memory", a, got, ram_[at]);
  }
  return {};
}

}  // namespace kaz::h8s::oracle
