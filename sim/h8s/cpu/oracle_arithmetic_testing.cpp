// The manual's arithmetic, logic, shifts and extensions, for the tests' own model.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/oracle_model_testing.h"

namespace kaz::h8s::oracle {
namespace {

using Run = std::function<void(World&, const Fields&)>;

u64 two_to(int bits) {
  return u64{1} << bits;
}
bool negative(int bits, u64 value) {
  return value % two_to(bits) >= two_to(bits - 1);
}
std::int64_t as_signed(int bits, u64 value) {
  const auto plain = static_cast<std::int64_t>(value % two_to(bits));
  return negative(bits, value) ? plain - static_cast<std::int64_t>(two_to(bits)) : plain;
}
bool fits(int bits, std::int64_t value) {
  const auto half = static_cast<std::int64_t>(two_to(bits - 1));
  return -half <= value && value < half;
}

void sign_and_zero(World& w, int bits, u64 result) {
  w.n = negative(bits, result);
  w.z = result % two_to(bits) == 0;
}

// V: the signed sum does not fit. C: the unsigned one does not. H: nor that of the low bits - 4.
u32 add(World& w, int bits, u64 a, u64 b, u64 carry, bool chained) {
  const u64 sum = a + b + carry, low = two_to(bits - 4);
  const u64 result = sum % two_to(bits);
  const bool was_zero = w.z;
  sign_and_zero(w, bits, result);
  if (chained) w.z = result == 0 && was_zero;
  w.v = !fits(bits, as_signed(bits, a) + as_signed(bits, b) + static_cast<std::int64_t>(carry));
  w.c = sum >= two_to(bits);
  w.h = a % low + b % low + carry >= low;
  return static_cast<u32>(result);
}

u32 subtract(World& w, int bits, u64 a, u64 b, u64 borrow, bool chained) {
  const u64 low = two_to(bits - 4);
  const u64 result = (a + two_to(bits) - b - borrow) % two_to(bits);
  const bool was_zero = w.z;
  sign_and_zero(w, bits, result);
  if (chained) w.z = result == 0 && was_zero;
  w.v = !fits(bits, as_signed(bits, a) - as_signed(bits, b) - static_cast<std::int64_t>(borrow));
  w.c = a < b + borrow;
  w.h = a % low < b % low + borrow;
  return static_cast<u32>(result);
}

// The operations of two operands; the result goes to Rd except that of CMP.
using Two = std::function<void(World&, int bits, u32 d, u32 operand)>;

void op_add(World& w, int bits, u32 d, u32 b) {
  w.set_reg(bits, d, add(w, bits, w.reg(bits, d), b, 0, false));
}
void op_sub(World& w, int bits, u32 d, u32 b) {
  w.set_reg(bits, d, subtract(w, bits, w.reg(bits, d), b, 0, false));
}
void op_cmp(World& w, int bits, u32 d, u32 b) {
  subtract(w, bits, w.reg(bits, d), b, 0, false);
}
void op_addx(World& w, int bits, u32 d, u32 b) {
  w.set_reg(bits, d, add(w, bits, w.reg(bits, d), b, w.c, true));
}
void op_subx(World& w, int bits, u32 d, u32 b) {
  w.set_reg(bits, d, subtract(w, bits, w.reg(bits, d), b, w.c, true));
}
void logic(World& w, int bits, u32 d, u32 result) {
  w.set_reg(bits, d, result);
  sign_and_zero(w, bits, result);
  w.v = false;
}
void op_and(World& w, int bits, u32 d, u32 b) {
  logic(w, bits, d, w.reg(bits, d) & b);
}
void op_or(World& w, int bits, u32 d, u32 b) {
  logic(w, bits, d, w.reg(bits, d) | b);
}
void op_xor(World& w, int bits, u32 d, u32 b) {
  logic(w, bits, d, w.reg(bits, d) ^ b);
}

Run immediate(Two op, int bits) {
  return [=](World& w, const Fields& f) { op(w, bits, f['d'], f['i']); };
}
Run registers(Two op, int bits) {
  return [=](World& w, const Fields& f) { op(w, bits, f['d'], w.reg(bits, f['s'])); };
}

void list_two_operands(std::vector<Form>& to) {
  const std::string i16 = " iiiiiiiiiiiiiiii", i32 = i16 + i16;
  const auto wide = [&](const std::string& name, const std::string& digit, const Two& op) {
    to.push_back({name + ".w #,Rd", "01111001 " + digit + "dddd" + i16, immediate(op, 16), {2}});
    to.push_back({name + ".l #,ERd", "01111010 " + digit + "0ddd" + i32, immediate(op, 32), {3}});
  };
  wide("add", "0001", op_add);
  wide("cmp", "0010", op_cmp);
  wide("sub", "0011", op_sub);
  wide("or", "0100", op_or);
  wide("xor", "0101", op_xor);
  wide("and", "0110", op_and);
  const auto byte = [&](const std::string& name, const std::string& digit, const Two& op) {
    to.push_back({name + " #,Rd", digit + "dddd iiiiiiii", immediate(op, 8), {1}});
  };
  byte("add.b", "1000", op_add);
  byte("addx", "1001", op_addx);
  byte("cmp.b", "1010", op_cmp);
  byte("subx", "1011", op_subx);
  byte("or.b", "1100", op_or);
  byte("xor.b", "1101", op_xor);
  byte("and.b", "1110", op_and);
  const auto both = [&](const std::string& name, const std::string& first, int bits,
                        const Two& op) {
    to.push_back({name + " Rs,Rd", first + " ssssdddd", registers(op, bits), {1}});
  };
  both("add.b", "00001000", 8, op_add);
  both("add.w", "00001001", 16, op_add);
  both("sub.b", "00011000", 8, op_sub);
  both("sub.w", "00011001", 16, op_sub);
  both("cmp.b", "00011100", 8, op_cmp);
  both("cmp.w", "00011101", 16, op_cmp);
  both("addx", "00001110", 8, op_addx);
  both("subx", "00011110", 8, op_subx);
  both("or.b", "00010100", 8, op_or);
  both("xor.b", "00010101", 8, op_xor);
  both("and.b", "00010110", 8, op_and);
  both("or.w", "01100100", 16, op_or);
  both("xor.w", "01100101", 16, op_xor);
  both("and.w", "01100110", 16, op_and);
  const auto longs = [&](const std::string& name, const std::string& bits, const Two& op, int i) {
    to.push_back({name + " ERs,ERd", bits, registers(op, 32), {i}});
  };
  longs("add.l", "00001010 1sss0ddd", op_add, 1);
  longs("sub.l", "00011010 1sss0ddd", op_sub, 1);
  longs("cmp.l", "00011111 1sss0ddd", op_cmp, 1);
  longs("or.l", "00000001 11110000 01100100 0sss0ddd", op_or, 2);
  longs("xor.l", "00000001 11110000 01100101 0sss0ddd", op_xor, 2);
  longs("and.l", "00000001 11110000 01100110 0sss0ddd", op_and, 2);
}

// INC, DEC leave H and C; ADDS, SUBS leave all flags.
Run step_by(int bits, int by) {
  return [=](World& w, const Fields& f) {
    const u32 a = w.reg(bits, f['d']);
    const u64 result =
        (a + two_to(bits) + static_cast<u64>(static_cast<std::int64_t>(by))) % two_to(bits);
    w.set_reg(bits, f['d'], static_cast<u32>(result));
    sign_and_zero(w, bits, result);
    w.v = !fits(bits, as_signed(bits, a) + by);
  };
}

Run address_by(int by) {
  return [=](World& w, const Fields& f) { w.er[f['d']] += static_cast<u32>(by); };
}

void neg(World& w, int bits, u32 d) {
  w.set_reg(bits, d, subtract(w, bits, 0, w.reg(bits, d), 0, false));
}
void bit_not(World& w, int bits, u32 d) {
  logic(w, bits, d, static_cast<u32>(two_to(bits) - 1 - w.reg(bits, d)));
}
void extu(World& w, int bits, u32 d) {
  logic(w, bits, d, static_cast<u32>(w.reg(bits, d) % two_to(bits / 2)));
}
void exts(World& w, int bits, u32 d) {
  logic(w, bits, d,
        static_cast<u32>(as_signed(bits / 2, w.reg(bits, d))) & static_cast<u32>(two_to(bits) - 1));
}

void list_one_operand(std::vector<Form>& to) {
  using One = void (*)(World&, int, u32);
  const auto one = [&](const char* name, const char* second, int bits, One op) {
    to.push_back({name,
                  std::string("00010111 ") + second + (bits == 32 ? "0ddd" : "dddd"),
                  [=](World& w, const Fields& f) { op(w, bits, f['d']); },
                  {1}});
  };
  one("not.b", "0000", 8, bit_not);
  one("not.w", "0001", 16, bit_not);
  one("not.l", "0011", 32, bit_not);
  one("extu.w", "0101", 16, extu);
  one("extu.l", "0111", 32, extu);
  one("neg.b", "1000", 8, neg);
  one("neg.w", "1001", 16, neg);
  one("neg.l", "1011", 32, neg);
  one("exts.w", "1101", 16, exts);
  one("exts.l", "1111", 32, exts);
  const auto add = [&](const char* name, const char* bits, Run run) {
    to.push_back({name, bits, std::move(run), {1}});
  };
  add("inc.b", "00001010 0000dddd", step_by(8, 1));
  add("inc.w #1", "00001011 0101dddd", step_by(16, 1));
  add("inc.w #2", "00001011 1101dddd", step_by(16, 2));
  add("inc.l #1", "00001011 01110ddd", step_by(32, 1));
  add("inc.l #2", "00001011 11110ddd", step_by(32, 2));
  add("dec.b", "00011010 0000dddd", step_by(8, -1));
  add("dec.w #1", "00011011 0101dddd", step_by(16, -1));
  add("dec.w #2", "00011011 1101dddd", step_by(16, -2));
  add("dec.l #1", "00011011 01110ddd", step_by(32, -1));
  add("dec.l #2", "00011011 11110ddd", step_by(32, -2));
  add("adds #1", "00001011 00000ddd", address_by(1));
  add("adds #2", "00001011 10000ddd", address_by(2));
  add("adds #4", "00001011 10010ddd", address_by(4));
  add("subs #1", "00011011 00000ddd", address_by(-1));
  add("subs #2", "00011011 10000ddd", address_by(-2));
  add("subs #4", "00011011 10010ddd", address_by(-4));
}

// One bit a time; V of SHAL: the sign changed at any step.
enum class Kind { shll, shal, shlr, shar, rotxl, rotl, rotxr, rotr };

Run shift(Kind kind, int bits, int times) {
  return [=](World& w, const Fields& f) {
    u64 x = w.reg(bits, f['d']);
    bool sign_changed = false;
    for (int k = 0; k < times; ++k) {
      const bool top = negative(bits, x), bottom = x % 2 == 1, carry = w.c;
      const u64 high = two_to(bits - 1);
      if (kind == Kind::shll || kind == Kind::shal) x = x * 2 % two_to(bits);
      if (kind == Kind::rotl) x = x * 2 % two_to(bits) + (top ? 1 : 0);
      if (kind == Kind::rotxl) x = x * 2 % two_to(bits) + (carry ? 1 : 0);
      if (kind == Kind::shlr) x = x / 2;
      if (kind == Kind::shar) x = x / 2 + (top ? high : 0);
      if (kind == Kind::rotr) x = x / 2 + (bottom ? high : 0);
      if (kind == Kind::rotxr) x = x / 2 + (carry ? high : 0);
      const bool left =
          kind == Kind::shll || kind == Kind::shal || kind == Kind::rotl || kind == Kind::rotxl;
      w.c = left ? top : bottom;
      sign_changed = sign_changed || negative(bits, x) != top;
    }
    w.set_reg(bits, f['d'], static_cast<u32>(x));
    sign_and_zero(w, bits, x);
    w.v = kind == Kind::shal && sign_changed;
  };
}

void list_shifts(std::vector<Form>& to) {
  const auto kind = [&](const std::string& name, const std::string& first, const char* high,
                        Kind k) {
    const auto row = [&](const char* suffix, const char* rest, int bits, int times) {
      to.push_back({name + suffix, first + high + rest, shift(k, bits, times), {1}});
    };
    row(".b", "000dddd", 8, 1);
    row(".w", "001dddd", 16, 1);
    row(".l", "0110ddd", 32, 1);
    row(".b #2", "100dddd", 8, 2);
    row(".w #2", "101dddd", 16, 2);
    row(".l #2", "1110ddd", 32, 2);
  };
  kind("shll", "00010000 ", "0", Kind::shll);
  kind("shal", "00010000 ", "1", Kind::shal);
  kind("shlr", "00010001 ", "0", Kind::shlr);
  kind("shar", "00010001 ", "1", Kind::shar);
  kind("rotxl", "00010010 ", "0", Kind::rotxl);
  kind("rotl", "00010010 ", "1", Kind::rotl);
  kind("rotxr", "00010011 ", "0", Kind::rotxr);
  kind("rotr", "00010011 ", "1", Kind::rotr);
}

// `half` is the width of the multiplier and divisor, Rd is twice as wide.
Run mulxu(int half) {
  return [=](World& w, const Fields& f) {
    const u64 a = w.reg(2 * half, f['d']) % two_to(half), b = w.reg(half, f['s']);
    w.set_reg(2 * half, f['d'], static_cast<u32>(a * b));
  };
}
Run mulxs(int half) {
  return [=](World& w, const Fields& f) {
    const std::int64_t product =
        as_signed(half, w.reg(2 * half, f['d'])) * as_signed(half, w.reg(half, f['s']));
    const u64 result = static_cast<u64>(product) % two_to(2 * half);
    w.set_reg(2 * half, f['d'], static_cast<u32>(result));
    sign_and_zero(w, 2 * half, result);
  };
}

void put_quotient(World& w, int half, u32 d, u64 quotient, u64 remainder) {
  w.set_reg(2 * half, d,
            static_cast<u32>(remainder % two_to(half) * two_to(half) + quotient % two_to(half)));
}
Run divxu(int half) {
  return [=](World& w, const Fields& f) {
    const u64 a = w.reg(2 * half, f['d']), b = w.reg(half, f['s']);
    w.n = negative(half, b);
    w.z = b == 0;
    w.open_result = b == 0 || a / b >= two_to(half);
    if (b != 0) put_quotient(w, half, f['d'], a / b, a % b);
  };
}
// C's division: the remainder has the dividend's sign.
Run divxs(int half) {
  return [=](World& w, const Fields& f) {
    const std::int64_t a = as_signed(2 * half, w.reg(2 * half, f['d']));
    const std::int64_t b = as_signed(half, w.reg(half, f['s']));
    w.z = b == 0;
    w.open_result = b == 0 || !fits(half, a / b);
    if (w.open_result) w.open_flags = 0x08;
    // Where the manual leaves the result open the emulator keeps Rd and takes the sign rule of division.
    w.n = b == 0 ? (a < 0) != (b < 0) : a / b < 0;
    if (b != 0) put_quotient(w, half, f['d'], static_cast<u64>(a / b), static_cast<u64>(a % b));
  };
}

void list_products(std::vector<Form>& to) {
  const auto row = [&](const char* name, const char* bits, Run run, int i, int n) {
    to.push_back({name, bits, std::move(run), {i, {}, {}, 0, 0, n}});
  };
  row("mulxu.b", "01010000 ssssdddd", mulxu(8), 1, 11);
  row("mulxu.w", "01010010 ssss0ddd", mulxu(16), 1, 19);
  row("divxu.b", "01010001 ssssdddd", divxu(8), 1, 11);
  row("divxu.w", "01010011 ssss0ddd", divxu(16), 1, 19);
  row("mulxs.b", "00000001 11000000 01010000 ssssdddd", mulxs(8), 2, 11);
  row("mulxs.w", "00000001 11000000 01010010 ssss0ddd", mulxs(16), 2, 19);
  row("divxs.b", "00000001 11010000 01010001 ssssdddd", divxs(8), 2, 11);
  row("divxs.w", "00000001 11010000 01010011 ssss0ddd", divxs(16), 2, 19);
}

// The manual's tables for decimal adjustment, row by row: C, high digit, H, low digit, added, C.
struct Decimal {
  bool c;
  u32 high_first, high_last;
  bool h;
  u32 low_first, low_last;
  u32 added;
  bool carry;
};

const Decimal kDaa[] = {
    {false, 0, 9, false, 0, 9, 0x00, false},   {false, 0, 8, false, 10, 15, 0x06, false},
    {false, 0, 9, true, 0, 3, 0x06, false},    {false, 10, 15, false, 0, 9, 0x60, true},
    {false, 9, 15, false, 10, 15, 0x66, true}, {false, 10, 15, true, 0, 3, 0x66, true},
    {true, 0, 2, false, 0, 9, 0x60, true},     {true, 0, 2, false, 10, 15, 0x66, true},
    {true, 0, 3, true, 0, 3, 0x66, true},
};
const Decimal kDas[] = {
    {false, 0, 9, false, 0, 9, 0x00, false},
    {false, 0, 8, true, 6, 15, 0xfa, false},
    {true, 7, 15, false, 0, 9, 0xa0, true},
    {true, 6, 15, true, 6, 15, 0x9a, true},
};

Run decimal(std::span<const Decimal> rows) {
  return [rows](World& w, const Fields& f) {
    const u32 a = w.reg(8, f['d']), high = a / 16, low = a % 16;
    w.open_flags = 0x22;
    for (const Decimal& r : rows) {
      if (r.c != w.c || r.h != w.h || high < r.high_first || high > r.high_last ||
          low < r.low_first || low > r.low_last)
        continue;
      const u32 result = (a + r.added) % 256;
      w.set_reg(8, f['d'], result);
      sign_and_zero(w, 8, result);
      w.c = r.carry;
      return;
    }
    w.open_result = true;
    w.open_flags = 0x2f;
  };
}

}  // namespace

void list_arithmetic(std::vector<Form>& to) {
  list_two_operands(to);
  list_one_operand(to);
  list_shifts(to);
  list_products(to);
  to.push_back({"daa", "00001111 0000dddd", decimal(kDaa), {1}});
  to.push_back({"das", "00011111 0000dddd", decimal(kDas), {1}});
}

}  // namespace kaz::h8s::oracle
