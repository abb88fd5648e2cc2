// Emits changes of the interrupt mask, and RTE. The interpreter runs them where a request is pending.
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>

#include "sim/h8s/translate/emitter.h"

namespace kaz::h8s::translate {
// As mask_changed() in cpu.h: nothing is to be done while no request is pending and the stretch goes on.
void Emitter::leave_for_interrupts(std::size_t k) {
  if (!c_.bus) return;
  const asmjit::Label out = before(k);
  a_.mov(host::rsi, host::ptr(kCpu, static_cast<std::int32_t>(offsetof(Cpu, pending))));
  a_.mov(host::rdi, host::ptr(host::rsi, 0, 8));
  a_.or_(host::rdi, host::ptr(host::rsi, 8, 8));
  a_.jnz(out);
  if (!near_end_ && k + 1 < block_->steps.size()) return;  // only the last step may end the stretch
  a_.cmp(kLeft, static_cast<std::int32_t>(states_before(k + 1)) -
                    static_cast<std::int32_t>(block_->bound));
  a_.jle(out);
}

void Emitter::emit_control(std::size_t k) {
  const Step& s = block_->steps[k];
  leave_for_interrupts(k);
  const host::Mem control = flag(offsetof(Cpu, control), 1);
  constexpr std::uint32_t mask_bits = 0xd0;
  switch (static_cast<Control>(s.form.detail)) {
    case Control::bit_and:
      a_.and_(control, s.insn.imm & mask_bits);
      break;
    case Control::bit_or:
      a_.or_(control, s.insn.imm & mask_bits);
      break;
    case Control::bit_xor:
      a_.xor_(control, s.insn.imm & mask_bits);
      break;
  }
}

void Emitter::emit_exception_return(std::size_t k) {
  using host::edi, host::esi, host::r15d;
  leave_for_interrupts(k);
  load(k, Mode::increment, 7, 4, [this](const host::Mem& at) { fetch_big(r15d, at, 4); });
  a_.mov(edi, r15d);  // CCR in its upper byte
  find_target(k);
  a_.add(gp(7), 4);
  pending_.fill(-1);
  a_.shr(edi, 24);
  a_.mov(esi, edi);
  a_.and_(esi, 0xd0);
  a_.mov(flag(offsetof(Cpu, control), 1), esi.r8());
  // A flag at bit `from` of CCR to bit `to` of its place.
  const auto move_flag = [&](unsigned from, unsigned to, std::size_t place) {
    a_.mov(esi, edi);
    a_.shl(esi, to - from);
    a_.and_(esi, 1u << to);
    a_.mov(flag(place), esi);
  };
  move_flag(5, 28, kOffsetH);
  move_flag(3, 31, kOffsetN);
  move_flag(1, 31, kOffsetV);
  a_.xor_(esi, esi);
  a_.test(edi, 4);
  a_.setz(esi.r8());
  a_.mov(flag(kOffsetZ), esi);
  a_.and_(edi, 1);
  a_.mov(flag(kOffsetC), edi);
  leave_through_table(k);
}

}  // namespace kaz::h8s::translate
