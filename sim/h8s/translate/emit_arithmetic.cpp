// Emits MOV between registers, and arithmetic.
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>

#include "sim/h8s/cpu/flags.h"
#include "sim/h8s/translate/emitter.h"

namespace kaz::h8s::translate {
namespace {


host::Inst::Id instruction(Op op) {
  switch (op) {
    case Op::mov:
      return host::Inst::kIdMov;
    case Op::add:
    case Op::inc:
      return host::Inst::kIdAdd;
    case Op::sub:
    case Op::dec:
      return host::Inst::kIdSub;
    case Op::bit_and:
      return host::Inst::kIdAnd;
    case Op::bit_or:
      return host::Inst::kIdOr;
    default:
      return host::Inst::kIdXor;
  }
}

std::uint32_t cut(std::uint32_t value, unsigned size) {
  return size == 4 ? value : value & ((1u << 8 * size) - 1);
}

}  // namespace

void Emitter::emit_mov(std::size_t k) {
  const Step& s = block_->steps[k];
  if (s.form.dst != Mode::reg) return emit_store(k);
  if (s.form.src != Mode::reg && s.form.src != Mode::imm) return emit_load(k);
  if (s.form.src == Mode::reg && s.insn.rs == s.insn.rd) return;  // for its flags alone
  emit_two(s);
  native_ = 0;
}

// Rd := Rd op source, MOV among them; on the low part of the host's register where it can be.
void Emitter::emit_two(const Step& s) {
  const unsigned size = s.form.size;
  const Op op = s.form.op;
  const host::Inst::Id id = instruction(op);
  const Part to = part_at(s.insn.rd, size);
  const bool counted = op == Op::inc || op == Op::dec;
  const bool immediate = counted || s.form.src != Mode::reg;
  const std::uint32_t value = counted ? s.form.count : cut(s.insn.imm, size);
  const Part from = immediate ? Part{} : part_at(s.insn.rs, size);
  bool turned = false;
  if (op == Op::add && !immediate && from == to) store_doubled(to, s.keep);
  if (high_byte(to) && (immediate || (from.reg < 4 && (from.shift == 0 || from.shift == 8)))) {
    if (immediate)
      a_.emit(id, high(to.reg), asmjit::Imm(value));
    else
      a_.emit(id, high(to.reg), from.shift == 8 ? high(from.reg) : low(from.reg, 1));
  } else {
    host::Gp source = immediate ? host::Gp() : low(from.reg, size);
    if (!immediate && (from.shift != 0 || (to.shift != 0 && from.reg == to.reg))) {
      get(host::esi, from);
      source = sized(host::esi, size);
    }
    if (immediate && size == 2 && op != Op::mov) {  // 16-bit immediates decode slowly
      a_.mov(host::esi, value);
      source = host::si;
    }
    turn(to);
    turned = to.shift != 0;
    if (immediate && !(size == 2 && op != Op::mov))
      a_.emit(id, low(to.reg, size), asmjit::Imm(value));
    else
      a_.emit(id, low(to.reg, size), source);
    if (turned) turn_back(to);
  }
  native_ = kN | kZ;
  if (turned) return;
  native_ |= kV;
  if (op != Op::add && op != Op::sub) return;
  native_ |= kC;
  if (s.keep & kC) {
    store_carry();
    stored_ |= kC;
  }
}

// A register is added to itself: V, H and C cannot be recomputed from the result.
void Emitter::store_doubled(Part part, unsigned keep) {
  using host::esi, host::r15d;
  if (!(keep & (kV | kH | kC))) return;
  get_up(esi, part);
  a_.lea(r15d, host::ptr(host::rsi, host::rsi));
  a_.mov(flag(kOffsetH), r15d);
  a_.xor_(r15d, esi);
  a_.mov(flag(kOffsetV), r15d);
  a_.bt(esi, 31);
  store_carry();
  stored_ |= kV | kH | kC;
}

// ADDX, SUBX: all flags go to memory.
void Emitter::emit_with_carry(const Step& s) {
  using host::edi, host::esi, host::r15d;
  const bool add = s.form.op == Op::addx;
  const Part to = part_at(s.insn.rd, 1);
  get(esi, to);
  if (s.form.src == Mode::reg)
    get(edi, part_at(s.insn.rs, 1));
  else
    a_.mov(edi, s.insn.imm & 0xff);
  a_.mov(r15d, esi);
  if (add) {
    a_.add(r15d, edi);
    a_.add(r15d, flag(kOffsetC));
  } else {
    a_.sub(r15d, edi);
    a_.sub(r15d, flag(kOffsetC));
  }
  a_.bt(r15d, 8);
  store_carry();
  put(to, r15d);
  a_.movzx(r15d, r15d.r8());
  a_.or_(flag(kOffsetZ), r15d);
  // n, and with a ^ r in esi and b ^ r or a ^ b in edi: h and v.
  if (add) {
    a_.xor_(esi, r15d);
    a_.shl(r15d, 24);
    a_.mov(flag(kOffsetN), r15d);
    a_.shr(r15d, 24);
    a_.xor_(r15d, edi);  // b ^ r
    a_.xor_(edi, esi);   // a ^ b ^ r
    a_.and_(esi, r15d);
  } else {
    a_.xor_(edi, esi);  // a ^ b
    a_.xor_(esi, r15d);
    a_.and_(esi, edi);
    a_.xor_(edi, r15d);
    a_.shl(r15d, 24);
    a_.mov(flag(kOffsetN), r15d);
  }
  a_.shl(esi, 24);
  a_.mov(flag(kOffsetV), esi);
  a_.shl(edi, 24);
  a_.mov(flag(kOffsetH), edi);
  stored_ = kAllFlags;
}

void Emitter::emit_one(const Step& s) {
  const Part to = part_at(s.insn.rd, s.form.size);
  if (s.form.op == Op::adds) {
    if (s.form.detail)
      a_.sub(gp(to.reg), s.form.count);
    else
      a_.add(gp(to.reg), s.form.count);
    return;
  }
  turn(to);
  const host::Gp r = low(to.reg, to.size);
  if (s.form.op == Op::neg) {
    a_.neg(r);
    if (to.shift == 0) {
      native_ = kN | kZ | kV | kC;
      if (s.keep & kC) {
        store_carry();
        stored_ |= kC;
      }
    }
  } else {
    a_.not_(r);
  }
  turn_back(to);
}

void Emitter::emit_extend(const Step& s) {
  const Part to = part_at(s.insn.rd, s.form.size);
  const bool with_sign = s.form.op == Op::exts;
  if (to.size == 4) {
    if (with_sign)
      a_.movsx(gp(to.reg), low(to.reg, 2));
    else
      a_.movzx(gp(to.reg), low(to.reg, 2));
    return;
  }
  turn(to);
  if (with_sign)
    a_.movsx(host::esi, low(to.reg, 1));
  else
    a_.movzx(host::esi, low(to.reg, 1));
  a_.mov(low(to.reg, 2), host::si);
  turn_back(to);
}

void Emitter::emit_multiply(const Step& s) {
  const unsigned size = s.form.size;
  const Part to = part_at(s.insn.rd, 2 * size);
  const Part a{to.reg, to.shift, static_cast<std::uint8_t>(size)};
  const auto take = [&](const host::Gp& r, Part part) {
    get(r, part);
    if (s.form.op == Op::mulxs) a_.movsx(r, sized(r, size));
  };
  take(host::esi, a);
  take(host::edi, part_at(s.insn.rs, size));
  a_.imul(host::esi, host::edi);
  if (to.size == 4)
    a_.mov(gp(to.reg), host::esi);
  else
    put(to, host::esi);
}

void Emitter::emit_shift(const Step& s) {
  const Part to = part_at(s.insn.rd, s.form.size);
  const auto kind = static_cast<Shift>(s.form.detail);
  const host::Gp r = low(to.reg, to.size);
  const int times = s.form.count;
  const bool sign_change = kind == Shift::shal && (s.keep & kV);
  if (sign_change) {  // of the old value: bits that differ from the next lower one
    get_up(host::esi, to);
    a_.lea(host::edi, host::ptr(host::rsi, host::rsi));
    a_.xor_(host::esi, host::edi);
    if (times == 2) {
      a_.lea(host::edi, host::ptr(host::rsi, host::rsi));
      a_.or_(host::esi, host::edi);
    }
    a_.mov(flag(kOffsetV), host::esi);
    stored_ |= kV;
  }
  turn(to);
  native_ = kN | kZ | kC;
  switch (kind) {
    case Shift::shll:
    case Shift::shal:
      a_.shl(r, times);
      if (kind == Shift::shal && times == 1) native_ |= kV;
      break;
    case Shift::shlr:
      a_.shr(r, times);
      break;
    case Shift::shar:
      a_.sar(r, times);
      break;
    case Shift::rotl:
      a_.rol(r, times);
      native_ = kC;
      break;
    case Shift::rotr:
      a_.ror(r, times);
      native_ = kC;
      break;
    case Shift::rotxl:
    case Shift::rotxr:
      a_.bt(flag(kOffsetC), 0);
      for (int n = 0; n < times; ++n) {
        if (kind == Shift::rotxl)
          a_.rcl(r, 1);
        else
          a_.rcr(r, 1);
      }
      native_ = kC;
      break;
  }
  if (s.keep & kC) {
    store_carry();
    stored_ |= kC;
  }
  if (to.shift != 0) native_ &= ~(kC | kV);
  turn_back(to);
}

}  // namespace kaz::h8s::translate
