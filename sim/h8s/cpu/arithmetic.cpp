// Addition to division, logic, extension and decimal adjustment.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/flags.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {
namespace {

using B = u8;
using W = u16;
using L = u32;

enum class Op { add, sub, cmp, bit_and, bit_or, bit_xor };

template <Op op, class T>
void apply(Cpu& c, unsigned rd, T b) {
  const T a = reg<T>(c, rd);
  if constexpr (op == Op::add)
    set_reg<T>(c, rd, flags_add<T>(c, a, b));
  else if constexpr (op == Op::sub)
    set_reg<T>(c, rd, flags_sub<T>(c, a, b));
  else if constexpr (op == Op::cmp)
    flags_sub<T>(c, a, b);
  else if constexpr (op == Op::bit_and)
    set_reg<T>(c, rd, flags_logic<T>(c, static_cast<T>(a & b)));
  else if constexpr (op == Op::bit_or)
    set_reg<T>(c, rd, flags_logic<T>(c, static_cast<T>(a | b)));
  else
    set_reg<T>(c, rd, flags_logic<T>(c, static_cast<T>(a ^ b)));
}

template <Op op, class T>
const Insn* alu_immediate(Cpu& c, const Insn* i) {
  apply<op, T>(c, i->rd, static_cast<T>(i->imm));
  return i + i->units;
}

template <Op op, class T>
const Insn* alu_register(Cpu& c, const Insn* i) {
  apply<op, T>(c, i->rd, reg<T>(c, i->rs));
  return i + i->units;
}

template <bool add>
const Insn* with_carry_immediate(Cpu& c, const Insn* i) {
  const u8 a = reg<u8>(c, i->rd), b = static_cast<u8>(i->imm);
  set_reg<u8>(c, i->rd, add ? flags_addx(c, a, b) : flags_subx(c, a, b));
  return i + 1;
}

template <bool add>
const Insn* with_carry_register(Cpu& c, const Insn* i) {
  const u8 a = reg<u8>(c, i->rd), b = reg<u8>(c, i->rs);
  set_reg<u8>(c, i->rd, add ? flags_addx(c, a, b) : flags_subx(c, a, b));
  return i + 1;
}

template <int by>
const Insn* adds(Cpu& c, const Insn* i) {
  set_reg<u32>(c, i->rd, ereg(c, i->rd) + static_cast<u32>(by));
  return i + 1;
}

template <class T, int by>
const Insn* inc(Cpu& c, const Insn* i) {
  set_reg<T>(c, i->rd, flags_inc<T>(c, reg<T>(c, i->rd), static_cast<T>(by)));
  return i + 1;
}

template <class T, int by>
const Insn* dec(Cpu& c, const Insn* i) {
  set_reg<T>(c, i->rd, flags_dec<T>(c, reg<T>(c, i->rd), static_cast<T>(by)));
  return i + 1;
}

template <class T>
const Insn* neg(Cpu& c, const Insn* i) {
  set_reg<T>(c, i->rd, flags_sub<T>(c, T{0}, reg<T>(c, i->rd)));
  return i + 1;
}

template <class T>
const Insn* bit_not(Cpu& c, const Insn* i) {
  set_reg<T>(c, i->rd, flags_logic<T>(c, static_cast<T>(~reg<T>(c, i->rd))));
  return i + 1;
}

template <class T>
const Insn* extu(Cpu& c, const Insn* i) {
  constexpr T half = static_cast<T>((T{1} << (kBits<T> / 2)) - 1);
  set_reg<T>(c, i->rd, flags_logic<T>(c, static_cast<T>(reg<T>(c, i->rd) & half)));
  return i + 1;
}

template <class T, class Half>
const Insn* exts(Cpu& c, const Insn* i) {
  const auto value = static_cast<Half>(reg<T>(c, i->rd));
  set_reg<T>(c, i->rd, flags_logic<T>(c, static_cast<T>(value)));
  return i + 1;
}

// Rd (twice as wide) := low half of Rd x Rs. No flags.
template <class T, class Wide>
const Insn* mulxu(Cpu& c, const Insn* i) {
  const T a = static_cast<T>(reg<Wide>(c, i->rd)), b = reg<T>(c, i->rs);
  set_reg<Wide>(c, i->rd, static_cast<Wide>(static_cast<u32>(a) * b));
  return i + 1;
}

template <class T, class Wide>
const Insn* mulxs(Cpu& c, const Insn* i) {
  using S = std::make_signed_t<T>;
  const S a = static_cast<S>(reg<Wide>(c, i->rd)), b = static_cast<S>(reg<T>(c, i->rs));
  const auto product = static_cast<Wide>(static_cast<std::int32_t>(a) * b);
  c.flags.n = c.flags.z = up<Wide>(product);
  set_reg<Wide>(c, i->rd, product);
  return i + 2;
}

// Rd := remainder : quotient, each half as wide as Rd. Division by 0 leaves Rd as it is; a quotient
// that does not fit is cut (the manual leaves both undefined).
template <class T, class Wide>
const Insn* divxu(Cpu& c, const Insn* i) {
  const Wide a = reg<Wide>(c, i->rd);
  const T b = reg<T>(c, i->rs);
  c.flags.n = c.flags.z = up<T>(b);
  if (b != 0) {
    const Wide packed =
        static_cast<Wide>(static_cast<Wide>(a % b) << kBits<T> | static_cast<T>(a / b));
    set_reg<Wide>(c, i->rd, packed);
  }
  return i + 1;
}

template <class T, class Wide>
const Insn* divxs(Cpu& c, const Insn* i) {
  const auto a =
      static_cast<std::int64_t>(static_cast<std::make_signed_t<Wide>>(reg<Wide>(c, i->rd)));
  const auto b = static_cast<std::int64_t>(static_cast<std::make_signed_t<T>>(reg<T>(c, i->rs)));
  c.flags.z = static_cast<u32>(b);
  c.flags.n = static_cast<u32>((a < 0) != (b < 0)) << 31;
  if (b != 0) {
    const std::int64_t quotient = a / b, remainder = a % b;
    c.flags.n = static_cast<u32>(quotient < 0) << 31;
    const auto packed = static_cast<Wide>(static_cast<u32>(static_cast<T>(remainder)) << kBits<T> |
                                          static_cast<T>(quotient));
    set_reg<Wide>(c, i->rd, packed);
  }
  return i + 2;
}

// Only sums and differences of two packed decimal bytes are defined; the rest follows the same
// rule.
const Insn* daa(Cpu& c, const Insn* i) {
  const u8 a = reg<u8>(c, i->rd);
  const u32 high = a >> 4, low = a & 15, half = c.flags.h >> 28 & 1;
  const bool low_adjust = half != 0 || low > 9;
  const bool high_adjust = c.flags.c != 0 || high > 9 || (high == 9 && low > 9 && half == 0);
  const u8 r = static_cast<u8>(a + (low_adjust ? 0x06 : 0) + (high_adjust ? 0x60 : 0));
  c.flags.n = c.flags.z = up<u8>(r);
  c.flags.c = high_adjust;
  set_reg<u8>(c, i->rd, r);
  return i + 1;
}

const Insn* das(Cpu& c, const Insn* i) {
  const u8 a = reg<u8>(c, i->rd);
  const bool half = (c.flags.h >> 28 & 1) != 0;
  const u8 r = static_cast<u8>(a + (half ? 0xfa : 0) + (c.flags.c ? 0xa0 : 0));
  c.flags.n = c.flags.z = up<u8>(r);
  set_reg<u8>(c, i->rd, r);
  return i + 1;
}

#define KAZ_LOGIC(op, name, b, reg_b, reg_w, imm)                               \
  {b "sii", name ".b", "#%i,%s", alu_immediate<op, B>, {1}},                    \
      {"79" imm "w iiii", name ".w", "#%i,%w", alu_immediate<op, W>, {2}},      \
      {"7A" imm "n iiii iiii", name ".l", "#%i,%n", alu_immediate<op, L>, {3}}, \
      {reg_b "rs", name ".b", "%r,%s", alu_register<op, B>, {1}},               \
      {reg_w "uw", name ".w", "%u,%w", alu_register<op, W>, {1}}, {             \
    "01F0 " reg_w "mn", name ".l", "%m,%n", alu_register<op, L>, {              \
      2                                                                         \
    }                                                                           \
  }

const Opcode kArithmetic[] = {
    {"8sii", "add.b", "#%i,%s", alu_immediate<Op::add, B>, {1}},
    {"791w iiii", "add.w", "#%i,%w", alu_immediate<Op::add, W>, {2}},
    {"7A1n iiii iiii", "add.l", "#%i,%n", alu_immediate<Op::add, L>, {3}},
    {"08rs", "add.b", "%r,%s", alu_register<Op::add, B>, {1}},
    {"09uw", "add.w", "%u,%w", alu_register<Op::add, W>, {1}},
    {"0AMn", "add.l", "%M,%n", alu_register<Op::add, L>, {1}},
    {"793w iiii", "sub.w", "#%i,%w", alu_immediate<Op::sub, W>, {2}},
    {"7A3n iiii iiii", "sub.l", "#%i,%n", alu_immediate<Op::sub, L>, {3}},
    {"18rs", "sub.b", "%r,%s", alu_register<Op::sub, B>, {1}},
    {"19uw", "sub.w", "%u,%w", alu_register<Op::sub, W>, {1}},
    {"1AMn", "sub.l", "%M,%n", alu_register<Op::sub, L>, {1}},
    {"Asii", "cmp.b", "#%i,%s", alu_immediate<Op::cmp, B>, {1}},
    {"792w iiii", "cmp.w", "#%i,%w", alu_immediate<Op::cmp, W>, {2}},
    {"7A2n iiii iiii", "cmp.l", "#%i,%n", alu_immediate<Op::cmp, L>, {3}},
    {"1Crs", "cmp.b", "%r,%s", alu_register<Op::cmp, B>, {1}},
    {"1Duw", "cmp.w", "%u,%w", alu_register<Op::cmp, W>, {1}},
    {"1FMn", "cmp.l", "%M,%n", alu_register<Op::cmp, L>, {1}},
    KAZ_LOGIC(Op::bit_or, "or", "C", "14", "64", "4"),
    KAZ_LOGIC(Op::bit_xor, "xor", "D", "15", "65", "5"),
    KAZ_LOGIC(Op::bit_and, "and", "E", "16", "66", "6"),

    {"9sii", "addx", "#%i,%s", with_carry_immediate<true>, {1}},
    {"0Ers", "addx", "%r,%s", with_carry_register<true>, {1}},
    {"Bsii", "subx", "#%i,%s", with_carry_immediate<false>, {1}},
    {"1Ers", "subx", "%r,%s", with_carry_register<false>, {1}},
    {"0B0n", "adds", "#1,%n", adds<1>, {1}},
    {"0B8n", "adds", "#2,%n", adds<2>, {1}},
    {"0B9n", "adds", "#4,%n", adds<4>, {1}},
    {"1B0n", "subs", "#1,%n", adds<-1>, {1}},
    {"1B8n", "subs", "#2,%n", adds<-2>, {1}},
    {"1B9n", "subs", "#4,%n", adds<-4>, {1}},
    {"0A0s", "inc.b", "%s", inc<B, 1>, {1}},
    {"0B5w", "inc.w", "#1,%w", inc<W, 1>, {1}},
    {"0BDw", "inc.w", "#2,%w", inc<W, 2>, {1}},
    {"0B7n", "inc.l", "#1,%n", inc<L, 1>, {1}},
    {"0BFn", "inc.l", "#2,%n", inc<L, 2>, {1}},
    {"1A0s", "dec.b", "%s", dec<B, 1>, {1}},
    {"1B5w", "dec.w", "#1,%w", dec<W, 1>, {1}},
    {"1BDw", "dec.w", "#2,%w", dec<W, 2>, {1}},
    {"1B7n", "dec.l", "#1,%n", dec<L, 1>, {1}},
    {"1BFn", "dec.l", "#2,%n", dec<L, 2>, {1}},
    {"178s", "neg.b", "%s", neg<B>, {1}},
    {"179w", "neg.w", "%w", neg<W>, {1}},
    {"17Bn", "neg.l", "%n", neg<L>, {1}},
    {"170s", "not.b", "%s", bit_not<B>, {1}},
    {"171w", "not.w", "%w", bit_not<W>, {1}},
    {"173n", "not.l", "%n", bit_not<L>, {1}},
    {"175w", "extu.w", "%w", extu<W>, {1}},
    {"177n", "extu.l", "%n", extu<L>, {1}},
    {"17Dw", "exts.w", "%w", exts<W, std::int8_t>, {1}},
    {"17Fn", "exts.l", "%n", exts<L, std::int16_t>, {1}},
    {"0F0s", "daa", "%s", daa, {1}},
    {"1F0s", "das", "%s", das, {1}},

    {"50rw", "mulxu.b", "%r,%w", mulxu<B, W>, {1, 0, 0, 0, 0, 11}},
    {"52un", "mulxu.w", "%u,%n", mulxu<W, L>, {1, 0, 0, 0, 0, 19}},
    {"01C0 50rw", "mulxs.b", "%r,%w", mulxs<B, W>, {2, 0, 0, 0, 0, 11}},
    {"01C0 52un", "mulxs.w", "%u,%n", mulxs<W, L>, {2, 0, 0, 0, 0, 19}},
    {"51rw", "divxu.b", "%r,%w", divxu<B, W>, {1, 0, 0, 0, 0, 11}},
    {"53un", "divxu.w", "%u,%n", divxu<W, L>, {1, 0, 0, 0, 0, 19}},
    {"01D0 51rw", "divxs.b", "%r,%w", divxs<B, W>, {2, 0, 0, 0, 0, 11}},
    {"01D0 53un", "divxs.w", "%u,%n", divxs<W, L>, {2, 0, 0, 0, 0, 19}},
};

#undef KAZ_LOGIC

}  // namespace

std::span<const Opcode> arithmetic_opcodes() {
  return kArithmetic;
}

}  // namespace kaz::h8s
