// The manual's data transfers, for the tests' own model of the CPU.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/oracle_model_testing.h"

namespace kaz::h8s::oracle {
namespace {

// Flags of MOV, of PUSH and POP: H and C stay.
void flags_of(World& w, int bits, u32 value) {
  w.n = value >> (bits - 1) & 1;
  w.z = value == 0;
  w.v = false;
}

u32 sign16(u32 d) {
  return d < 0x8000 ? d : d + 0xffff0000;
}

// Effective addresses of MOV and of LDC, STC; may change the address register.
using Where = std::function<u32(World&, const Fields&, int bytes)>;

struct Mode {
  const char* name;
  const char* load;   // from the unit that holds the mode on: r address register, d data register
  const char* store;  //
  Where load_from, store_to;
  int fetches;   // units beside the prefix
  int internal;  // N
};

u32 plain(World& w, const Fields& f, int) {
  return w.er[f['r']];
}
u32 displaced16(World& w, const Fields& f, int) {
  return w.er[f['r']] + sign16(f['o']);
}
u32 displaced32(World& w, const Fields& f, int) {
  return w.er[f['r']] + f['o'];
}
u32 after(World& w, const Fields& f, int bytes) {
  const u32 at = w.er[f['r']];
  w.er[f['r']] += static_cast<u32>(bytes);
  return at;
}
u32 before(World& w, const Fields& f, int bytes) {
  return w.er[f['r']] -= static_cast<u32>(bytes);
}
u32 absolute16(World&, const Fields& f, int) {
  return sign16(f['a']);
}
u32 absolute32(World&, const Fields& f, int) {
  return f['a'];
}

// Bytes: 68, 6E, 78..6A, 6C, 6A. Words and longwords: one more, with the data register's top bit 0
// for longwords. W stands for that bit of the opcode, DDDD for the data register.
const Mode kModes[] = {
    {"@ERn", "0110100W 0rrrDDDD", "0110100W 1rrrDDDD", plain, plain, 1, 0},
    {"@(d:16,ERn)", "0110111W 0rrrDDDD oooooooooooooooo", "0110111W 1rrrDDDD oooooooooooooooo",
     displaced16, displaced16, 2, 0},
    {"@(d:32,ERn)", "01111000 xrrr0000 0110101W 0010DDDD oooooooooooooooooooooooooooooooo",
     "01111000 xrrr0000 0110101W 1010DDDD oooooooooooooooooooooooooooooooo", displaced32,
     displaced32, 4, 0},
    {"@ERn+/@-ERn", "0110110W 0rrrDDDD", "0110110W 1rrrDDDD", after, before, 1, 1},
    {"@aa:16", "0110101W 0000DDDD aaaaaaaaaaaaaaaa", "0110101W 1000DDDD aaaaaaaaaaaaaaaa",
     absolute16, absolute16, 2, 0},
    {"@aa:32", "0110101W 0010DDDD aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa",
     "0110101W 1010DDDD aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", absolute32, absolute32, 3, 0},
};

std::string put(std::string pattern, char wide, const char* data) {
  for (char& ch : pattern) {
    if (ch == 'W') ch = wide;
  }
  const std::size_t at = pattern.find("DDDD");
  return pattern.replace(at, 4, data);
}

void list_memory(std::vector<Form>& to, int bits) {
  const char suffix = bits == 8 ? 'b' : bits == 16 ? 'w' : 'l';
  const std::string name = std::string("mov.") + suffix + " ";
  const std::string prefix = bits == 32 ? "00000001 00000000 " : "";
  const char wide = bits == 8 ? '0' : '1';
  const char* data = bits == 32 ? "0ddd" : "dddd";
  for (const Mode& m : kModes) {
    Cycles n;
    n.i = m.fetches + (bits == 32 ? 1 : 0);
    n.l = bits == 8 ? 1 : 0;
    n.m = bits / 16;
    n.n = m.internal;
    to.push_back({name + m.name + ",Rd", prefix + put(m.load, wide, data),
                  [bits, from = m.load_from](World& w, const Fields& f) {
                    const u32 value = w.load(bits, from(w, f, bits / 8));
                    flags_of(w, bits, value);
                    w.set_reg(bits, f['d'], value);
                  },
                  n});
    to.push_back({name + "Rs," + m.name, prefix + put(m.store, wide, data),
                  [bits, where = m.store_to](World& w, const Fields& f) {
                    const u32 old = w.reg(bits, f['d']);
                    const u32 at = where(w, f, bits / 8);
                    const u32 value = w.predecrement_stores_decremented ? w.reg(bits, f['d']) : old;
                    w.store(bits, at, value);
                    flags_of(w, bits, value);
                  },
                  n});
  }
}

// LDC and STC: words with the register in the even byte.
void list_control_registers(std::vector<Form>& to, bool exr) {
  const std::string prefix = exr ? "00000001 01000001 " : "00000001 01000000 ";
  const std::string name = exr ? "exr" : "ccr";
  for (const Mode& m : kModes) {
    const Cycles n{m.fetches + 1, {}, {}, 0, 1, m.internal};
    to.push_back({"ldc " + std::string(m.name) + "," + name, prefix + put(m.load, '1', "0000"),
                  [exr, from = m.load_from](World& w, const Fields& f) {
                    const u8 value = static_cast<u8>(w.load(16, from(w, f, 2)) / 256);
                    if (exr)
                      w.exr = value | 0x78;
                    else
                      w.set_ccr(value);
                  },
                  n});
    to.push_back({"stc " + name + "," + m.name, prefix + put(m.store, '1', "0000"),
                  [exr, where = m.store_to](World& w, const Fields& f) {
                    const u32 value = exr ? w.exr : w.ccr();
                    w.store(16, where(w, f, 2), value * 256);
                  },
                  n});
  }
}

void list_registers(std::vector<Form>& to) {
  const auto move = [](int bits) {
    return [bits](World& w, const Fields& f) {
      const u32 value = w.reg(bits, f['s']);
      w.set_reg(bits, f['d'], value);
      flags_of(w, bits, value);
    };
  };
  const auto immediate = [](int bits) {
    return [bits](World& w, const Fields& f) {
      w.set_reg(bits, f['d'], f['i']);
      flags_of(w, bits, f['i']);
    };
  };
  to.push_back({"mov.b #,Rd", "1111dddd iiiiiiii", immediate(8), {1}});
  to.push_back({"mov.w #,Rd", "01111001 0000dddd iiiiiiiiiiiiiiii", immediate(16), {2}});
  to.push_back(
      {"mov.l #,ERd", "01111010 00000ddd iiiiiiiiiiiiiiiiiiiiiiiiiiiiiiii", immediate(32), {3}});
  to.push_back({"mov.b Rs,Rd", "00001100 ssssdddd", move(8), {1}});
  to.push_back({"mov.w Rs,Rd", "00001101 ssssdddd", move(16), {1}});
  to.push_back({"mov.l ERs,ERd", "00001111 1sss0ddd", move(32), {1}});
  const Cycles one_byte{1, {}, {}, 1};
  to.push_back({"mov.b @aa:8,Rd", "0010dddd aaaaaaaa",
                [](World& w, const Fields& f) {
                  const u32 value = w.load(8, 0xffff00 + f['a']);
                  w.set_reg(8, f['d'], value);
                  flags_of(w, 8, value);
                },
                one_byte});
  to.push_back({"mov.b Rs,@aa:8", "0011ssss aaaaaaaa",
                [](World& w, const Fields& f) {
                  const u32 value = w.reg(8, f['s']);
                  w.store(8, 0xffff00 + f['a'], value);
                  flags_of(w, 8, value);
                },
                one_byte});
}

// STM pushes the lowest register first, LDM pops the highest first.
void list_multiple(std::vector<Form>& to, const char* count_bits, u32 count, u32 first,
                   const char* first_bits, const char* last_bits) {
  const int k = 2 * static_cast<int>(count);
  const Cycles n{2, {}, {k, k}, 0, 0, 1};
  const std::string prefix = std::string("00000001 ") + count_bits + "0000 01101101 ";
  to.push_back({"stm.l", prefix + "11110" + first_bits,
                [=](World& w, const Fields&) {
                  for (u32 r = first; r < first + count; ++r) {
                    w.push16(w.er[r] % 65536);
                    w.push16(w.er[r] / 65536);
                  }
                },
                n});
  to.push_back({"ldm.l", prefix + "01110" + last_bits,
                [=](World& w, const Fields&) {
                  for (u32 r = first + count; r-- > first;) {
                    const u32 high = w.pop16();
                    w.er[r] = high * 65536 + w.pop16();
                  }
                },
                n});
}

}  // namespace

void list_moves(std::vector<Form>& to) {
  list_registers(to);
  for (const int bits : {8, 16, 32}) list_memory(to, bits);
  list_control_registers(to, false);
  list_control_registers(to, true);
  list_multiple(to, "0001", 2, 0, "000", "001");
  list_multiple(to, "0001", 2, 2, "010", "011");
  list_multiple(to, "0001", 2, 4, "100", "101");
  list_multiple(to, "0010", 3, 0, "000", "010");
  list_multiple(to, "0010", 3, 4, "100", "110");
  list_multiple(to, "0011", 4, 0, "000", "011");
}

}  // namespace kaz::h8s::oracle
