// Emits accesses to guest registers and their parts in host registers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/translate/emitter.h"

namespace kaz::h8s::translate {

host::Gp Emitter::gp(unsigned reg) {
  static constexpr std::uint8_t ids[] = {0, 3, 1, 2, 8, 9, 10, 11};
  return host::gpd(ids[reg]);
}

host::Gp Emitter::sized(const host::Gp& r, unsigned size) {
  if (size == 1) return r.r8();
  if (size == 2) return r.r16();
  return r.r32();
}

host::Gp Emitter::low(unsigned reg, unsigned size) {
  return sized(gp(reg), size);
}

host::Gp Emitter::high(unsigned reg) {
  return gp(reg).r8Hi();
}

void Emitter::get(const host::Gp& to, Part part) {
  if (part.size == 4) {
    a_.mov(to, gp(part.reg));
  } else if (part.shift == 0) {
    a_.movzx(to, low(part.reg, part.size));
  } else if (part.size == 1 && high_byte(part) && to.id() < 8) {
    a_.movzx(to, high(part.reg));
  } else {
    a_.mov(to, gp(part.reg));
    a_.shr(to, part.shift);
    if (part.size == 1) a_.movzx(to, to.r8());
  }
}

void Emitter::turn(Part part) {
  if (part.shift != 0) a_.ror(gp(part.reg), part.shift);
}

void Emitter::turn_back(Part part) {
  if (part.shift != 0) a_.rol(gp(part.reg), part.shift);
}

void Emitter::put(Part part, const host::Gp& from) {
  turn(part);
  a_.mov(low(part.reg, part.size), sized(from, part.size));
  turn_back(part);
}

void Emitter::get_up(const host::Gp& to, Part part) {
  a_.mov(to, gp(part.reg));
  const int left = 32 - part.shift - 8 * part.size;
  if (left != 0) a_.shl(to, left);
  if (part.shift != 0) a_.and_(to, part.size == 1 ? -0x1000000 : -0x10000);
}

void Emitter::get_operand_up(const host::Gp& to, const Definition& d) {
  if (d.immediate)
    a_.mov(to, d.value << (32 - 8 * d.r.size));
  else
    get_up(to, d.b);
}

}  // namespace kaz::h8s::translate
