// The manual's bit instructions, branches and system control, for the tests' own model.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/oracle_model_testing.h"

namespace kaz::h8s::oracle {
namespace {

// --- bits
// Effect on a byte and on Z or C, given the bit number; true: the byte changes.
using Bit = std::function<void(World&, u32& byte, u32 number)>;

struct BitRow {
  const char* name;
  const char* code;  // 7 bits of the opcode's first byte after its top 0
  bool inverse;      // top bit of the bit number's nibble
  bool writes;
  Bit act;
};

bool bit_of(u32 byte, u32 number) {
  return byte >> number & 1;
}
void put_bit(u32& byte, u32 number, bool on) {
  byte = (byte & ~(1u << number)) | (on ? 1u << number : 0u);
}

const Bit kSet = [](World&, u32& byte, u32 k) { put_bit(byte, k, true); };
const Bit kNot = [](World&, u32& byte, u32 k) { put_bit(byte, k, !bit_of(byte, k)); };
const Bit kClear = [](World&, u32& byte, u32 k) { put_bit(byte, k, false); };
const Bit kTest = [](World& w, u32& byte, u32 k) { w.z = !bit_of(byte, k); };

const BitRow kImmediate[] = {
    {"bset", "01110000", false, true, kSet},
    {"bnot", "01110001", false, true, kNot},
    {"bclr", "01110010", false, true, kClear},
    {"btst", "01110011", false, false, kTest},
    {"bor", "01110100", false, false,
     [](World& w, u32& byte, u32 k) { w.c = w.c || bit_of(byte, k); }},
    {"bior", "01110100", true, false,
     [](World& w, u32& byte, u32 k) { w.c = w.c || !bit_of(byte, k); }},
    {"bxor", "01110101", false, false,
     [](World& w, u32& byte, u32 k) { w.c = w.c != bit_of(byte, k); }},
    {"bixor", "01110101", true, false,
     [](World& w, u32& byte, u32 k) { w.c = w.c == bit_of(byte, k); }},
    {"band", "01110110", false, false,
     [](World& w, u32& byte, u32 k) { w.c = w.c && bit_of(byte, k); }},
    {"biand", "01110110", true, false,
     [](World& w, u32& byte, u32 k) { w.c = w.c && !bit_of(byte, k); }},
    {"bld", "01110111", false, false, [](World& w, u32& byte, u32 k) { w.c = bit_of(byte, k); }},
    {"bild", "01110111", true, false, [](World& w, u32& byte, u32 k) { w.c = !bit_of(byte, k); }},
    {"bst", "01100111", false, true, [](World& w, u32& byte, u32 k) { put_bit(byte, k, w.c); }},
    {"bist", "01100111", true, true, [](World& w, u32& byte, u32 k) { put_bit(byte, k, !w.c); }},
};
const BitRow kByRegister[] = {
    {"bset", "01100000", false, true, kSet},
    {"bnot", "01100001", false, true, kNot},
    {"bclr", "01100010", false, true, kClear},
    {"btst", "01100011", false, false, kTest},
};

void list_bit(std::vector<Form>& to, const BitRow& row, bool by_register) {
  const std::string number = by_register ? "nnnn" : row.inverse ? "1nnn" : "0nnn";
  const std::string name = row.name + std::string(by_register ? " Rn," : " #,");
  const auto number_of = [by_register](const World& w, const Fields& f) {
    return by_register ? w.reg(8, f['n']) % 8 : f['n'];
  };
  to.push_back({name + "Rd",
                row.code + number + "dddd",
                [=, act = row.act](World& w, const Fields& f) {
                  u32 byte = w.reg(8, f['d']);
                  act(w, byte, number_of(w, f));
                  w.set_reg(8, f['d'], byte);
                },
                {1}});
  const auto memory = [&](const char* mode, const std::string& prefix, int fetches,
                          std::function<u32(World&, const Fields&)> where) {
    const Cycles n{fetches, {}, {}, row.writes ? 2 : 1};
    to.push_back({name + mode, prefix + row.code + number + "0000",
                  [=, act = row.act, writes = row.writes](World& w, const Fields& f) {
                    const u32 at = where(w, f);
                    u32 byte = w.load(8, at);
                    act(w, byte, number_of(w, f));
                    if (writes) w.store(8, at, byte);
                  },
                  n});
  };
  const std::string w = row.writes ? "1" : "0";
  memory("@ERd", "0111110" + w + "0ddd0000", 2,
         [](World& x, const Fields& f) { return x.er[f['d']]; });
  memory("@aa:8", "0111111" + w + "aaaaaaaa", 2,
         [](World&, const Fields& f) { return 0xffff00 + f['a']; });
  memory("@aa:16", "01101010 0001" + w + "000 aaaaaaaaaaaaaaaa", 3,
         [](World&, const Fields& f) { return f['a'] < 0x8000 ? f['a'] : f['a'] + 0xff0000; });
  memory("@aa:32", "01101010 0011" + w + "000 aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", 4,
         [](World&, const Fields& f) { return f['a']; });
}

// --- branches
bool condition(const World& w, u32 code) {
  switch (code) {
    case 0:
      return true;
    case 1:
      return false;
    case 2:
      return !(w.c || w.z);
    case 3:
      return w.c || w.z;
    case 4:
      return !w.c;
    case 5:
      return w.c;
    case 6:
      return !w.z;
    case 7:
      return w.z;
    case 8:
      return !w.v;
    case 9:
      return w.v;
    case 10:
      return !w.n;
    case 11:
      return w.n;
    case 12:
      return w.n == w.v;
    case 13:
      return w.n != w.v;
    case 14:
      return !(w.z || w.n != w.v);
    default:
      return w.z || w.n != w.v;
  }
}

u32 distance8(u32 d) {
  return d < 0x80 ? d : d + 0xffffff00;
}
u32 distance16(u32 d) {
  return d < 0x8000 ? d : d + 0xffff0000;
}
u32 vector(World& w, u32 address) {
  return w.load_uncounted(w.normal ? 16 : 32, address);
}

void list_branches(std::vector<Form>& to) {
  const std::array<int, 2> one_word{1, 2}, none{};
  const auto row = [&](const char* name, const char* bits, Cycles n,
                       std::function<void(World&, const Fields&)> run) {
    to.push_back({name, bits, std::move(run), n});
  };
  row("bcc d:8", "0100cccc oooooooo", {2}, [](World& w, const Fields& f) {
    if (condition(w, f['c'])) w.pc = f.next + distance8(f['o']);
  });
  row("bcc d:16", "01011000 cccc0000 oooooooooooooooo", {2, {}, {}, 0, 0, 1},
      [](World& w, const Fields& f) {
        if (condition(w, f['c'])) w.pc = f.next + distance16(f['o']);
      });
  row("bsr d:8", "01010101 oooooooo", {2, none, one_word}, [](World& w, const Fields& f) {
    w.push_return(f.next);
    w.pc = f.next + distance8(f['o']);
  });
  row("bsr d:16", "01011100 00000000 oooooooooooooooo", {2, none, one_word, 0, 0, 1},
      [](World& w, const Fields& f) {
        w.push_return(f.next);
        w.pc = f.next + distance16(f['o']);
      });
  row("jmp @ERn", "01011001 0rrr0000", {2}, [](World& w, const Fields& f) { w.pc = w.er[f['r']]; });
  row("jmp @aa:24", "01011010 aaaaaaaaaaaaaaaaaaaaaaaa", {2, {}, {}, 0, 0, 1},
      [](World& w, const Fields& f) { w.pc = f['a']; });
  row("jmp @@aa:8", "01011011 aaaaaaaa", {2, one_word, none, 0, 0, 1},
      [](World& w, const Fields& f) { w.pc = vector(w, f['a']); });
  row("jsr @ERn", "01011101 0rrr0000", {2, none, one_word}, [](World& w, const Fields& f) {
    const u32 target = w.er[f['r']];
    w.push_return(f.next);
    w.pc = target;
  });
  row("jsr @aa:24", "01011110 aaaaaaaaaaaaaaaaaaaaaaaa", {2, none, one_word, 0, 0, 1},
      [](World& w, const Fields& f) {
        w.push_return(f.next);
        w.pc = f['a'];
      });
  row("jsr @@aa:8", "01011111 aaaaaaaa", {2, one_word, one_word}, [](World& w, const Fields& f) {
    const u32 target = vector(w, f['a']);
    w.push_return(f.next);
    w.pc = target;
  });
  row("rts", "01010100 01110000", {2, none, one_word, 0, 0, 1}, [](World& w, const Fields&) {
    const u32 high = w.normal ? 0 : w.pop16();
    w.pc = high * 65536 + w.pop16();
  });
}

// --- control
void list_control_immediate(std::vector<Form>& to) {
  const auto row = [&](const std::string& name, const std::string& code, auto combine) {
    to.push_back({name + " #,ccr",
                  "000001" + code + "iiiiiiii",
                  [=](World& w, const Fields& f) {
                    w.set_ccr(static_cast<u8>(combine(u32{w.ccr()}, f['i'])));
                  },
                  {1}});
    to.push_back({name + " #,exr",
                  "00000001 01000001 000001" + code + "iiiiiiii",
                  [=](World& w, const Fields& f) {
                    w.exr = static_cast<u8>(combine(u32{w.exr}, f['i']) | 0x78);
                  },
                  {2}});
  };
  row("orc", "00", [](u32 a, u32 b) { return a | b; });
  row("xorc", "01", [](u32 a, u32 b) { return a ^ b; });
  row("andc", "10", [](u32 a, u32 b) { return a & b; });
  row("ldc", "11", [](u32, u32 b) { return b; });
  to.push_back({"stc ccr,Rd",
                "00000010 0000dddd",
                [](World& w, const Fields& f) { w.set_reg(8, f['d'], w.ccr()); },
                {1}});
  to.push_back({"stc exr,Rd",
                "00000010 0001dddd",
                [](World& w, const Fields& f) { w.set_reg(8, f['d'], w.exr); },
                {1}});
  to.push_back({"ldc Rs,ccr",
                "00000011 0000ssss",
                [](World& w, const Fields& f) { w.set_ccr(static_cast<u8>(w.reg(8, f['s']))); },
                {1}});
  to.push_back({"ldc Rs,exr",
                "00000011 0001ssss",
                [](World& w, const Fields& f) { w.exr = static_cast<u8>(w.reg(8, f['s']) | 0x78); },
                {1}});
}

// Stacks PC, then CCR and the upper part of PC (normal mode: CCR twice).
void trapa(World& w, const Fields& f) {
  w.push16(f.next % 65536);
  w.push16(w.ccr() * 256u + (w.normal ? w.ccr() : f.next / 65536));
  w.i = true;
  w.pc = vector(w, (8 + f['n']) * (w.normal ? 2 : 4));
}

void rte(World& w, const Fields&) {
  const u32 first = w.pop16();
  w.set_ccr(static_cast<u8>(first / 256));
  w.pc = (w.normal ? 0 : first % 256 * 65536) + w.pop16();
}

std::function<void(World&, const Fields&)> eepmov(int bits) {
  return [bits](World& w, const Fields&) {
    const u32 field = bits == 8 ? 12 : 4;  // R4L, R4
    for (; w.reg(bits, field) != 0; w.set_reg(bits, field, w.reg(bits, field) - 1)) {
      w.write(w.er[6]++ & w.mask(), w.read(w.er[5]++ & w.mask()));
      ++w.block_bytes;
    }
  };
}

}  // namespace

void list_bits(std::vector<Form>& to) {
  for (const BitRow& row : kImmediate) list_bit(to, row, false);
  for (const BitRow& row : kByRegister) list_bit(to, row, true);
}

void list_control(std::vector<Form>& to) {
  list_branches(to);
  list_control_immediate(to);
  const std::array<int, 2> two{2, 2}, one_word{1, 2}, none{};
  to.push_back({"nop", "00000000 00000000", [](World&, const Fields&) {}, {1}});
  to.push_back({"sleep",
                "00000001 10000000",
                [](World& w, const Fields&) { w.asleep = true; },
                {1, {}, {}, 0, 0, 1}});
  to.push_back({"trapa", "01010111 00nn0000", trapa, {2, one_word, two, 0, 0, 2}});
  to.push_back({"rte", "01010110 01110000", rte, {2, none, two, 0, 0, 1}});
  to.push_back({"tas",
                "00000001 11100000 01111011 0rrr1100",
                [](World& w, const Fields& f) {
                  const u32 at = w.er[f['r']], byte = w.load(8, at);
                  w.n = byte >= 0x80;
                  w.z = byte == 0;
                  w.v = false;
                  w.store(8, at, byte | 0x80);
                },
                {2, {}, {}, 2}});
  to.push_back({"eepmov.b", "01111011 01011100 01011001 10001111", eepmov(8), {2, {}, {}, 2}});
  to.push_back({"eepmov.w", "01111011 11010100 01011001 10001111", eepmov(16), {2, {}, {}, 2}});
}

}  // namespace kaz::h8s::oracle
