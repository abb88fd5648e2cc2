// Bit instructions, in registers and in memory.
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>

#include "sim/h8s/translate/emitter.h"

namespace kaz::h8s::translate {
namespace {


bool writes(Op op) {
  return op == Op::bset || op == Op::bnot || op == Op::bclr || op == Op::bst;
}

}  // namespace

// On bits `shift` to `shift` + 7 of `r`. Uses r15.
void Emitter::bit_in_register(const Step& s, const host::Gp& r, unsigned shift) {
  using host::r15d;
  const unsigned bit = shift + s.insn.rs % 8;  // of the forms with a literal number
  const std::uint32_t mask = 1u << bit;
  const bool inverted = s.form.detail != 0;
  if (s.form.number_in_register) {
    get(r15d, part_at(s.insn.rs, 1));
    a_.and_(r15d, 7);
    if (shift != 0) a_.add(r15d, shift);
  }
  const bool variable = s.form.number_in_register;
  switch (s.form.op) {
    case Op::bset:
      variable ? a_.bts(r, r15d) : a_.or_(r, mask);
      break;
    case Op::bnot:
      variable ? a_.btc(r, r15d) : a_.xor_(r, mask);
      break;
    case Op::bclr:
      variable ? a_.btr(r, r15d) : a_.and_(r, ~mask);
      break;
    case Op::bst:
      a_.and_(r, ~mask);
      a_.mov(r15d, flag(kOffsetC));
      if (inverted) a_.xor_(r15d, 1);
      if (bit != 0) a_.shl(r15d, bit);
      a_.or_(r, r15d);
      break;
    case Op::btst:
      if (!(s.keep & kZ)) break;
      variable ? a_.bt(r, r15d) : a_.bt(r, bit);
      a_.mov(flag(kOffsetZ), 0);
      a_.set(host::CondCode::kC, flag(kOffsetZ, 1));
      stored_ |= kZ;
      break;
    default: {
      if (!(s.keep & kC)) break;
      a_.bt(r, bit);
      stored_ |= kC;
      if (s.form.op == Op::bld) {
        store_carry(inverted);
        break;
      }
      a_.set(inverted ? host::CondCode::kNC : host::CondCode::kC, r15d.r8());
      const host::Mem carry = flag(kOffsetC, 1);
      if (s.form.op == Op::bor)
        a_.or_(carry, r15d.r8());
      else if (s.form.op == Op::bxor)
        a_.xor_(carry, r15d.r8());
      else
        a_.and_(carry, r15d.r8());
    }
  }
}

void Emitter::emit_bit(std::size_t k) {
  const Step& s = block_->steps[k];
  if (s.form.dst == Mode::reg) {
    const Part part = part_at(s.insn.rd, 1);
    bit_in_register(s, gp(part.reg), part.shift);
    return;
  }
  if (s.io) {
    load_io(k);
    bit_in_register(s, host::edi, 0);
    if (!writes(s.form.op)) return;
    a_.mov(host::r15d, host::edi);
    return store_io(k);
  }
  if (writes(s.form.op)) {
    const host::Mem at = writable(k, s.form.dst, s.insn.rd / 4, 1, 1);
    fetch_big(host::edi, at, 1);
    bit_in_register(s, host::edi, 0);
    store_big(at, host::edi, 1);
    return;
  }
  load(k, s.form.dst, s.insn.rd / 4, 1,
       [this](const host::Mem& at) { fetch_big(host::edi, at, 1); });
  bit_in_register(s, host::edi, 0);
}

}  // namespace kaz::h8s::translate
