// Instructions on bytes with every operand and every flag that matters, against the tests' model.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/h8s/cpu/oracle_testing.h"

namespace kaz::h8s::oracle {
namespace {

const Form& form(const std::string& name) {
  for (const Form& f : forms()) {
    if (f.name == name) return f;
  }
  ADD_FAILURE() << "no form " << name;
  return forms().front();
}

Fields fields(u32 source, u32 destination) {
  Fields f;
  f.value['s' - 'a'] = source;
  f.value['d' - 'a'] = destination;
  return f;
}

// R1L and R0L; E and the high bytes hold something that must stay.
World operands(u32 source, u32 destination, u32 ccr) {
  World w;
  w.er = {0xabcd1200 | destination, 0x98765400 | source, 3, 4, 5, 6, 7, 0xffee00};
  w.set_ccr(static_cast<u8>(0x80 | ccr));
  return w;
}

// Flags that go in: Z and C where the sum is chained, else C.
TEST(EveryByte, TwoOperands) {
  Bench bench(false);
  for (const char* name : {"add.b Rs,Rd", "sub.b Rs,Rd", "cmp.b Rs,Rd", "addx Rs,Rd", "subx Rs,Rd",
                           "and.b Rs,Rd", "or.b Rs,Rd", "xor.b Rs,Rd"}) {
    const Form& f = form(name);
    const auto units = encode(f, fields(9, 8));
    const bool chained = f.name.find('x') == 3;
    for (u32 a = 0; a < 256; ++a) {
      for (u32 b = 0; b < 256; ++b) {
        for (const u32 ccr : {0x00u, 0x05u, 0x01u, 0x04u}) {
          if (!chained && (ccr == 0x01 || ccr == 0x04)) continue;
          const std::string text = bench.trial(f, units, operands(a, b, ccr), Bench::kRamCode);
          ASSERT_TRUE(text.empty()) << text;
        }
      }
    }
  }
}

TEST(EveryByte, Products) {
  Bench bench(false);
  for (const char* name : {"mulxu.b", "mulxs.b"}) {
    const Form& f = form(name);
    const auto units = encode(f, fields(9, 0));
    for (u32 a = 0; a < 256; ++a) {
      for (u32 b = 0; b < 256; ++b) {
        const std::string text = bench.trial(f, units, operands(a, b, a & 15), Bench::kRamCode);
        ASSERT_TRUE(text.empty()) << text;
      }
    }
  }
}

// Every dividend by divisors at the borders.
TEST(EveryByte, Quotients) {
  Bench bench(false);
  for (const char* name : {"divxu.b", "divxs.b"}) {
    const Form& f = form(name);
    const auto units = encode(f, fields(9, 0));
    for (const u32 divisor : {0u, 1u, 7u, 0x7fu, 0x80u, 0xffu}) {
      for (u32 dividend = 0; dividend < 0x10000; ++dividend) {
        World w = operands(divisor, 0, dividend & 15);
        w.er[0] = 0x12340000 | dividend;
        const std::string text = bench.trial(f, units, w, Bench::kRamCode);
        ASSERT_TRUE(text.empty()) << text;
      }
    }
  }
}

// H, N, Z, V and C go in.
TEST(EveryByte, OneOperand) {
  Bench bench(false);
  std::vector<std::string> names{"inc.b", "dec.b", "neg.b", "not.b", "daa", "das"};
  for (const char* kind : {"shll", "shal", "shlr", "shar", "rotxl", "rotl", "rotxr", "rotr"}) {
    names.push_back(std::string(kind).append(".b"));
    names.push_back(std::string(kind).append(".b #2"));
  }
  for (const std::string& name : names) {
    const Form& f = form(name);
    for (const u32 destination : {0u, 8u}) {
      const auto units = encode(f, fields(0, destination));
      for (u32 a = 0; a < 256; ++a) {
        for (u32 flags = 0; flags < 32; ++flags) {
          const u32 ccr = (flags & 15) | (flags & 16) << 1;
          World w = operands(0, a, ccr);
          if (destination == 0) w.er[0] = 0xabcd0012 | a << 8;
          const std::string text = bench.trial(f, units, w, Bench::kRamCode);
          ASSERT_TRUE(text.empty()) << text;
        }
      }
    }
  }
}

// Every bit of every byte, with C and Z 0 and 1; and by a register whose upper bits are random.
TEST(EveryByte, Bits) {
  Bench bench(false);
  int found = 0;
  for (const Form& f : forms()) {
    const bool immediate = f.name.find(" #,Rd") != std::string::npos && f.name[0] == 'b';
    const bool by_register = f.name.find(" Rn,Rd") != std::string::npos;
    if (!immediate && !by_register) continue;
    ++found;
    for (u32 number = 0; number < 8; ++number) {
      Fields values = fields(0, 8);
      values.value['n' - 'a'] = immediate ? number : 9;
      const auto units = encode(f, values);
      for (u32 a = 0; a < 256; ++a) {
        for (const u32 ccr : {0x00u, 0x01u, 0x04u, 0x05u, 0x2au}) {
          const World w = operands(immediate ? 0 : number + (a & 0xf8), a, ccr);
          const std::string text = bench.trial(f, units, w, Bench::kRamCode);
          ASSERT_TRUE(text.empty()) << text;
        }
      }
    }
  }
  EXPECT_EQ(found, 18);
}

// Every value of CCR, in and out, and every condition on it.
TEST(EveryByte, ConditionCodes) {
  Bench bench(false);
  for (u32 ccr = 0; ccr < 256; ++ccr) {
    World w = operands(0x5a, 0xa5, 0);
    w.set_ccr(static_cast<u8>(ccr));
    for (const char* name :
         {"stc ccr,Rd", "orc #,ccr", "xorc #,ccr", "andc #,ccr", "ldc #,ccr", "ldc Rs,ccr"}) {
      const Form& f = form(name);
      Fields values = fields(9, 8);
      values.value['i' - 'a'] = ccr * 5 & 0xff;
      const std::string text = bench.trial(f, encode(f, values), w, Bench::kRamCode);
      ASSERT_TRUE(text.empty()) << text;
    }
    for (const char* name : {"bcc d:8", "bcc d:16"}) {
      const Form& f = form(name);
      for (u32 condition = 0; condition < 16; ++condition) {
        Fields values;
        values.value['c' - 'a'] = condition;
        values.value['o' - 'a'] = 0x7e;
        const std::string text = bench.trial(f, encode(f, values), w, Bench::kFlashCode);
        ASSERT_TRUE(text.empty()) << text;
      }
    }
  }
}

}  // namespace
}  // namespace kaz::h8s::oracle
