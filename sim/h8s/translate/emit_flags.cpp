// Emits guest flags: stores to memory, or recomputation where a branch needs them.
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>

#include "sim/h8s/translate/emitter.h"

namespace kaz::h8s::translate {
void Emitter::store_carry(bool inverted) {
  a_.set(inverted ? host::CondCode::kNC : host::CondCode::kC, flag(kOffsetC, 1));
}

void Emitter::store_flags(const Definition& d, unsigned mask) {
  using host::edi, host::esi, host::r15d;
  if (mask == 0) return;
  if (d.from == From::zero) {
    if (mask & kN) a_.mov(flag(kOffsetN), 0);
    if (mask & kZ) a_.mov(flag(kOffsetZ), 0);
    if (mask & kV) a_.mov(flag(kOffsetV), 0);
    if (mask & kH) a_.mov(flag(kOffsetH), 0);
    if (mask & kC) a_.mov(flag(kOffsetC), 0);
    return;
  }
  if (d.from == From::bit) {
    get(esi, d.r);
    a_.and_(esi, d.value);
    a_.mov(flag(kOffsetZ), esi);
    return;
  }
  const bool plain = d.from == From::result;
  const unsigned further = plain ? 0u : mask & (kV | kH | kC);
  // r in esi, b in edi, a in r15.
  if (plain && d.r.size == 4 && (mask & (kN | kZ))) {
    if (mask & kN) a_.mov(flag(kOffsetN), gp(d.r.reg));
    if (mask & kZ) a_.mov(flag(kOffsetZ), gp(d.r.reg));
    mask &= ~(kN | kZ);
  }
  if (d.from == From::cmp) {
    get_up(r15d, d.r);
    get_operand_up(edi, d);
    a_.mov(esi, r15d);
    a_.sub(esi, edi);
  } else if (further != 0 || (mask & (kN | kZ))) {
    get_up(esi, d.r);
  }
  if (further != 0) {
    if (d.from == From::neg) {
      a_.mov(edi, esi);
      a_.neg(edi);
      a_.xor_(r15d, r15d);
    } else if (d.from != From::cmp) {
      get_operand_up(edi, d);
      a_.mov(r15d, esi);
      if (d.from == From::add)
        a_.sub(r15d, edi);
      else
        a_.add(r15d, edi);
    }
  }
  if (mask & kN) a_.mov(flag(kOffsetN), esi);
  if (mask & kZ) a_.mov(flag(kOffsetZ), esi);
  if (plain) {
    if (mask & kV) a_.mov(flag(kOffsetV), 0);
    return;
  }
  if (mask & kC) {
    if (d.from == From::add)
      a_.cmp(esi, edi);
    else
      a_.cmp(r15d, edi);
    a_.set(host::CondCode::kB, flag(kOffsetC, 1));
  }
  if (!(mask & (kV | kH))) return;
  a_.xor_(r15d, esi);  // a ^ r
  if (mask & kV) {
    a_.xor_(esi, edi);                            // b ^ r
    if (d.from != From::add) a_.xor_(esi, r15d);  // a ^ b
    a_.and_(esi, r15d);
    a_.mov(flag(kOffsetV), esi);
  }
  if (mask & kH) {
    a_.xor_(r15d, edi);
    a_.mov(flag(kOffsetH), r15d);
  }
}

void Emitter::store_pending(const Pending& pending, const Block& block, unsigned mask) {
  for (std::size_t f = 0; f < kFlags; ++f) {
    if (!(mask >> f & 1) || pending[f] < 0) continue;
    unsigned together = 0;
    for (std::size_t g = f; g < kFlags; ++g) {
      if ((mask >> g & 1) && pending[g] == pending[f]) together |= 1u << g;
    }
    store_flags(block.steps[static_cast<std::size_t>(pending[f])].definition, together);
    mask &= ~together;
  }
}

void Emitter::compare_again(const Definition& d) {
  using host::edi, host::esi;
  switch (d.from) {
    case From::zero:
      a_.xor_(esi, esi);
      break;
    case From::bit:
      get(esi, d.r);
      a_.test(esi, d.value);
      break;
    case From::result:
      if (d.r.shift == 0) {
        a_.test(low(d.r.reg, d.r.size), low(d.r.reg, d.r.size));
      } else {
        get_up(esi, d.r);
        a_.test(esi, esi);
      }
      break;
    case From::cmp:
      if (d.r.shift == 0 && d.immediate && d.r.size != 2) {
        a_.cmp(low(d.r.reg, d.r.size), d.r.size == 1 ? d.value & 0xff : d.value);
      } else if (d.r.shift == 0 && !d.immediate && d.b.shift == 0) {
        a_.cmp(low(d.r.reg, d.r.size), low(d.b.reg, d.r.size));
      } else {
        get_up(esi, d.r);
        if (d.immediate) {
          a_.cmp(esi, d.value << (32 - 8 * d.r.size));
        } else {
          get_up(edi, d.b);
          a_.cmp(esi, edi);
        }
      }
      break;
    case From::add:
      get_up(esi, d.r);
      get_operand_up(edi, d);
      a_.sub(esi, edi);
      a_.add(esi, edi);
      break;
    case From::sub:
      get_up(esi, d.r);
      get_operand_up(edi, d);
      a_.add(esi, edi);
      a_.sub(esi, edi);
      break;
    case From::neg:
      get_up(esi, d.r);
      a_.neg(esi);
      a_.neg(esi);
      break;
    case From::nothing:
      break;
  }
}

}  // namespace kaz::h8s::translate
