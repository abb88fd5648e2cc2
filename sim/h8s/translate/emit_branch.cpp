// Emits blocks, the edges between them and the exits.
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>

#include "sim/h8s/translate/emitter.h"

namespace kaz::h8s::translate {
namespace {

constexpr auto kOffsetEr = static_cast<std::int32_t>(offsetof(Cpu, er));

// Guest condition to host condition, after a comparison of the same operands.
host::CondCode condition_code(unsigned condition) {
  using C = host::CondCode;
  static constexpr C codes[] = {C::kO,  C::kO, C::kA,  C::kBE, C::kAE, C::kB, C::kNE, C::kE,
                                C::kNO, C::kO, C::kNS, C::kS,  C::kGE, C::kL, C::kG,  C::kLE};
  return codes[condition];
}

}  // namespace

Emitter::Emitter(Cpu& cpu, asmjit::CodeHolder& code, Entry* entries, NearEnd* near_ends,
                 const Gate& gate)
    : c_(cpu),
      a_(&code),
      entries_(entries),
      near_ends_(near_ends),
      gate_(gate),
      movbe_(asmjit::CpuInfo::host().hasFeature(asmjit::CpuFeatures::X86::kMOVBE)) {}

std::uint64_t Emitter::entry_offset(const asmjit::CodeHolder& code, std::size_t n) const {
  return code.labelOffset(outside_[n]);
}

void Emitter::emit(const std::vector<Block>& blocks) {
  blocks_ = &blocks;
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    block_at_[blocks[n].start] = n;
    inside_.push_back(a_.newLabel());
    outside_.push_back(a_.newLabel());
    late_.push_back(a_.newLabel());
  }
  for (std::size_t n = 0; n < blocks.size(); ++n) emit_block(n);
  emit_cold();
}

void Emitter::emit_cold() {
  for (std::size_t k = 0; k < cold_.size(); ++k) {
    const auto piece = cold_[k];
    piece();
  }
}

void Emitter::emit_block(std::size_t n) {
  block_ = &(*blocks_)[n];
  const Block& block = *block_;
  a_.bind(outside_[n]);
  a_.sub(kLeft, block.bound);
  a_.jle(late_[n]);
  cold_.push_back([this, n] { emit_late(n); });
  a_.bind(inside_[n]);
  pending_.fill(-1);
  native_ = 0;
  proofs_.fill({});
  again_.clear();
  Pending pending{};  // before the first step that may go on in the second version
  for (std::size_t k = 0; k < block.steps.size(); ++k) {
    has_before_ = false;
    stored_ = 0;
    if (again_.empty()) pending = pending_;
    emit_step(k);
    move_proofs(block.steps[k]);
  }
  emit_end();
  if (again_.empty()) return;
  cold_.push_back([this, n, pending, again = again_] { emit_again(n, again, pending); });
}

void Emitter::emit_again(std::size_t n, const Again& again, const Pending& pending) {
  block_ = &(*blocks_)[n];
  pending_ = pending;
  native_ = 0;
  second_ = true;
  for (std::size_t k = again.begin()->first; k < block_->steps.size(); ++k) {
    if (const auto from = again.find(k); from != again.end()) a_.bind(from->second);
    has_before_ = false;
    stored_ = 0;
    emit_step(k);
  }
  emit_end();
  second_ = false;
}

// All flags are in memory.
void Emitter::emit_late(std::size_t n) {
  const Block& block = (*blocks_)[n];
  const asmjit::Label absent = a_.newLabel();
  a_.bind(late_[n]);
  a_.add(kLeft, block.bound);
  a_.mov(host::rsi, reinterpret_cast<std::uint64_t>(&near_ends_[block.start].code));
  a_.mov(host::rsi, host::ptr(host::rsi));
  a_.test(host::rsi, host::rsi);
  a_.jz(absent);
  a_.jmp(host::rsi);
  a_.bind(absent);
  emit_out(block.start, kGoOn);
}

// Flags are in memory wherever a step ends, since any may be the last one.
void Emitter::emit_near_end(const Block& whole) {
  Block block = whole;
  for (Step& s : block.steps) s.exits = true;
  settle_flags(block);
  block_ = &block;
  const asmjit::Label end = a_.newLabel();
  a_.test(kLeft, kLeft);
  a_.jle(end);
  a_.sub(kLeft, block.bound);
  cold_.push_back([this, end, &block] {
    a_.bind(end);
    emit_out(block.start, kGoOn);
  });
  pending_.fill(-1);
  native_ = 0;
  second_ = near_end_ = true;
  for (std::size_t k = 0; k < block.steps.size(); ++k) {
    has_before_ = false;
    stored_ = 0;
    emit_step(k);
    if (k + 1 < block.steps.size()) leave_at_end(k);
  }
  emit_end();
  emit_cold();
}

void Emitter::leave_at_end(std::size_t k) {
  a_.cmp(kLeft, static_cast<std::int32_t>(states_before(k + 1)) -
                    static_cast<std::int32_t>(block_->bound));
  a_.jle(after(k));
  native_ = 0;
}

void Emitter::emit_end() {
  const Block& block = *block_;
  if (block.end == End::next) {
    emit_edge(block.steps.size(), block.after);
  } else if (block.end == End::interpret) {
    store_pending(pending_, block, kAllFlags);
    a_.add(kLeft, static_cast<std::int32_t>(block.bound) - static_cast<std::int32_t>(block.states));
    a_.add(kExecuted, block.steps.size());
    emit_out(block.after, kInterpret);
  }
  for (std::size_t k = 0; k < side_.size(); ++k) {
    const auto piece = side_[k];
    piece();
  }
  side_.clear();
}

void Emitter::emit_step(std::size_t k) {
  const Step& s = block_->steps[k];
  const unsigned native = native_;
  native_ = 0;
  switch (s.form.op) {
    case Op::mov:
      emit_mov(k);
      break;
    case Op::add:
    case Op::sub:
    case Op::bit_and:
    case Op::bit_or:
    case Op::bit_xor:
    case Op::inc:
    case Op::dec:
      emit_two(s);
      break;
    case Op::addx:
    case Op::subx:
      emit_with_carry(s);
      break;
    case Op::adds:
    case Op::neg:
    case Op::bit_not:
      emit_one(s);
      break;
    case Op::extu:
    case Op::exts:
      emit_extend(s);
      break;
    case Op::shift:
      emit_shift(s);
      break;
    case Op::mulxu:
    case Op::mulxs:
      emit_multiply(s);
      break;
    case Op::bset:
    case Op::bnot:
    case Op::bclr:
    case Op::bst:
    case Op::btst:
    case Op::bor:
    case Op::bxor:
    case Op::band:
    case Op::bld:
      emit_bit(k);
      break;
    case Op::stm:
    case Op::ldm:
      emit_multiple(k);
      break;
    case Op::handler:
      emit_handler(s);
      break;
    case Op::interpreted:
      return emit_interpreted(k);
    case Op::bcc:
      return emit_condition(k, native);
    case Op::bsr:
    case Op::jsr:
      return emit_call(k);
    case Op::jmp:
      return emit_jump(k);
    case Op::rts:
      return emit_return(k);
    case Op::rte:
      return emit_exception_return(k);
    case Op::control:
      emit_control(k);
      break;
    case Op::cmp:  // the flags are computed where they are read
    case Op::nop:
    case Op::none:
      break;
  }
  const unsigned rest = s.keep & ~stored_;
  if (rest != 0) {
    store_flags(s.definition, rest);
    native_ = 0;
  }
  for (std::size_t f = 0; f < kFlags; ++f) {
    if (s.sets >> f & 1)
      pending_[f] = static_cast<std::int16_t>(s.keep >> f & 1 ? -1 : static_cast<int>(k));
  }
  if (s.io && !near_end_) leave_after(k);
}

void Emitter::leave_after(std::size_t k) {
  a_.test(kLeft, kLeft);
  a_.jle(after(k));
  native_ = 0;
}

asmjit::Label Emitter::after(std::size_t k) {
  const asmjit::Label leave = a_.newLabel();
  cold_.push_back([this, k, leave, &block = *block_, pending = pending_] {
    a_.bind(leave);
    store_pending(pending, block, kAllFlags);
    const Step& s = block.steps[k];
    const std::uint32_t states =
        k + 1 < block.steps.size() ? block.steps[k + 1].before : block.states;
    a_.add(kLeft, static_cast<std::int32_t>(block.bound) - static_cast<std::int32_t>(states));
    a_.add(kExecuted, k + 1);
    emit_out(s.index + s.insn.units, kGoOn);
  });
  return leave;
}

// The interpreter's handler, for instructions that neither branch nor touch memory.
void Emitter::emit_handler(const Step& s) {
  for (unsigned n = 0; n < 8; ++n)
    a_.mov(host::ptr(kCpu, kOffsetEr + 4 * static_cast<std::int32_t>(n), 4), gp(n));
  a_.mov(host::rdi, kCpu);
  a_.mov(host::rsi, reinterpret_cast<std::uint64_t>(c_.code + s.index));
  a_.mov(host::r15, reinterpret_cast<std::uint64_t>(s.insn.run));
  a_.call(host::r15);
  for (unsigned n = 0; n < 8; ++n)
    a_.mov(gp(n), host::ptr(kCpu, kOffsetEr + 4 * static_cast<std::int32_t>(n), 4));
  stored_ = kAllFlags;
}

// All flags are in memory before and after (block.cpp).
void Emitter::emit_interpreted(std::size_t k) {
  const Step& s = block_->steps[k];
  a_.mov(host::rdi, reinterpret_cast<std::uint64_t>(c_.code + s.index));
  a_.mov(host::rsi, static_cast<std::int64_t>(block_->bound) -
                        static_cast<std::int64_t>(states_before(k + 1)));
  if (s.form.detail != 0) {
    a_.add(kExecuted, k + 1);
    a_.jmp(asmjit::Imm(reinterpret_cast<std::uint64_t>(gate_.go_elsewhere)));
    return;
  }
  a_.call(asmjit::Imm(reinterpret_cast<std::uint64_t>(gate_.interpret)));
  const asmjit::Label leave = a_.newLabel();
  a_.jle(leave);
  pending_.fill(-1);
  cold_.push_back([this, k, leave] {
    a_.bind(leave);
    a_.add(kExecuted, k + 1);
    a_.jmp(asmjit::Imm(reinterpret_cast<std::uint64_t>(gate_.leave_complete)));
  });
}

void Emitter::emit_out(std::uint32_t index, std::uint32_t answer) {
  a_.mov(host::edi, index);
  a_.mov(host::esi, answer);
  a_.jmp(asmjit::Imm(reinterpret_cast<std::uint64_t>(gate_.leave)));
}

std::uint32_t Emitter::states_before(std::size_t k) const {
  return k < block_->steps.size() ? block_->steps[k].before : block_->states;
}

asmjit::Label Emitter::before(std::size_t k) {
  if (has_before_) return before_;
  has_before_ = true;
  before_ = a_.newLabel();
  const Block& block = *block_;
  cold_.push_back([this, k, &block, label = before_, pending = pending_] {
    a_.bind(label);
    store_pending(pending, block, kAllFlags);
    const Step& s = block.steps[k];
    a_.add(kLeft, block.bound - s.before);
    if (k != 0) a_.add(kExecuted, k);
    emit_out(s.index, kInterpret);
  });
  return before_;
}

void Emitter::emit_edge(std::size_t steps, std::uint32_t target) {
  const std::uint32_t states = states_before(steps);
  a_.add(kExecuted, steps);
  const auto found = block_at_.find(target);
  if (found == block_at_.end()) {
    const asmjit::Label absent = a_.newLabel();
    store_pending(pending_, *block_, kAllFlags);
    a_.add(kLeft, static_cast<std::int32_t>(block_->bound) - static_cast<std::int32_t>(states));
    a_.mov(host::rsi, reinterpret_cast<std::uint64_t>(&entries_[target].code));
    a_.mov(host::rsi, host::ptr(host::rsi));
    a_.test(host::rsi, host::rsi);
    a_.jz(absent);
    a_.jmp(host::rsi);
    cold_.push_back([this, absent, target] {
      a_.bind(absent);
      emit_out(target, kGoOn);
    });
    return;
  }
  const Block& next = (*blocks_)[found->second];
  const asmjit::Label late = a_.newLabel();
  a_.sub(kLeft,
         static_cast<std::int32_t>(states + next.bound) - static_cast<std::int32_t>(block_->bound));
  a_.jle(late);
  store_pending(pending_, *block_, next.live);
  a_.jmp(inside_[found->second]);
  cold_.push_back([this, late, &block = *block_, n = found->second, pending = pending_] {
    a_.bind(late);
    store_pending(pending, block, kAllFlags);
    a_.jmp(late_[n]);
  });
}

void Emitter::emit_condition(std::size_t k, unsigned native) {
  const Step& s = block_->steps[k];
  const unsigned condition = s.form.detail;
  if (condition == 0) return emit_edge(k + 1, s.target);
  if (condition == 1) return;
  const unsigned wanted = flags_of_condition(condition);
  host::CondCode code = condition_code(condition);
  const int source = common_source(*block_, k, wanted);
  using host::edi, host::esi;
  if ((native & wanted) == wanted) {
    // The host's flags are the guest's.
  } else if (source >= 0) {
    compare_again(block_->steps[static_cast<std::size_t>(source)].definition);
  } else {
    // From memory: Z is set where z is 0; bit 31 of n and v counts.
    const bool inverted = (condition & 1) == 0;
    switch (condition >> 1) {
      case 0x1:  // hi, ls
        a_.cmp(flag(kOffsetZ), 1);
        a_.sbb(esi, esi);
        a_.or_(esi, flag(kOffsetC));
        code = inverted ? host::CondCode::kZ : host::CondCode::kNZ;
        break;
      case 0x2:  // cc, cs
        a_.cmp(flag(kOffsetC), 0);
        code = inverted ? host::CondCode::kZ : host::CondCode::kNZ;
        break;
      case 0x3:  // ne, eq
        a_.cmp(flag(kOffsetZ), 0);
        code = inverted ? host::CondCode::kNZ : host::CondCode::kZ;
        break;
      case 0x4:  // vc, vs
        a_.cmp(flag(kOffsetV), 0);
        code = inverted ? host::CondCode::kNS : host::CondCode::kS;
        break;
      case 0x5:  // pl, mi
        a_.cmp(flag(kOffsetN), 0);
        code = inverted ? host::CondCode::kNS : host::CondCode::kS;
        break;
      case 0x6:  // ge, lt
        a_.mov(esi, flag(kOffsetN));
        a_.xor_(esi, flag(kOffsetV));
        code = inverted ? host::CondCode::kNS : host::CondCode::kS;
        break;
      default:  // gt, le
        a_.cmp(flag(kOffsetZ), 1);
        a_.sbb(edi, edi);
        a_.mov(esi, flag(kOffsetN));
        a_.xor_(esi, flag(kOffsetV));
        a_.or_(esi, edi);
        code = inverted ? host::CondCode::kNS : host::CondCode::kS;
        break;
    }
  }
  const asmjit::Label taken = a_.newLabel();
  a_.j(code, taken);
  side_.push_back([this, k, taken, target = s.target, pending = pending_] {
    a_.bind(taken);
    pending_ = pending;
    emit_edge(k + 1, target);
  });
}

void Emitter::find_target(std::size_t k) {
  using host::r15d;
  const asmjit::Label in_ram = a_.newLabel(), found = a_.newLabel(), out = before(k);
  if (c_.flat) {  // all of it is RAM from 0 on, and an odd address an error
    a_.test(r15d, 1);
    a_.jnz(out);
    a_.and_(r15d, c_.mask);
    return;
  }
  a_.and_(r15d, c_.mask & ~1u);
  a_.cmp(r15d, c_.flash_size);
  a_.jae(in_ram);
  a_.bind(found);
  cold_.push_back([this, in_ram, found, out] {
    a_.bind(in_ram);
    a_.sub(r15d, c_.ram_base);
    a_.cmp(r15d, c_.ram_size);
    a_.jae(out);
    a_.add(r15d, 2 * c_.ram_code);
    a_.jmp(found);
  });
}

// All flags are in memory, r15 holds twice the index.
void Emitter::leave_through_table(std::size_t k) {
  a_.add(kExecuted, k + 1);
  a_.add(kLeft, static_cast<std::int32_t>(block_->bound) -
                    static_cast<std::int32_t>(states_before(k + 1)));
  const asmjit::Label absent = a_.newLabel();
  a_.mov(host::rsi, reinterpret_cast<std::uint64_t>(entries_));
  a_.mov(host::rsi, host::ptr(host::rsi, host::r15, 3));
  a_.test(host::rsi, host::rsi);
  a_.jz(absent);
  a_.jmp(host::rsi);
  cold_.push_back([this, absent] {
    a_.bind(absent);
    a_.mov(host::edi, host::r15d);
    a_.shr(host::edi, 1);
    a_.xor_(host::esi, host::esi);
    a_.jmp(asmjit::Imm(reinterpret_cast<std::uint64_t>(gate_.leave)));
  });
}

void Emitter::emit_call(std::size_t k) {
  const Step& s = block_->steps[k];
  const bool known = s.form.op == Op::bsr || s.form.src == Mode::absolute;
  if (!known) {
    store_pending(pending_, *block_, kAllFlags);
    pending_.fill(-1);
    a_.mov(host::r15d, gp(s.insn.rs / 4));
    find_target(k);
  }
  const host::Mem at = writable(k, Mode::decrement, 7, 4, 4);
  const std::uint32_t back = (pc_of(c_, c_.code + s.index) + 2u * s.insn.units) & 0xffffff;
  a_.mov(at, __builtin_bswap32(back));
  a_.sub(gp(7), 4);
  if (known)
    emit_edge(k + 1, s.target);
  else
    leave_through_table(k);
}

void Emitter::emit_jump(std::size_t k) {
  const Step& s = block_->steps[k];
  if (s.form.src == Mode::absolute) return emit_edge(k + 1, s.target);
  store_pending(pending_, *block_, kAllFlags);
  pending_.fill(-1);
  a_.mov(host::r15d, gp(s.insn.rs / 4));
  find_target(k);
  leave_through_table(k);
}

void Emitter::emit_return(std::size_t k) {
  store_pending(pending_, *block_, kAllFlags);
  pending_.fill(-1);
  load(k, Mode::increment, 7, 4, [this](const host::Mem& at) { fetch_big(host::r15d, at, 4); });
  find_target(k);
  a_.add(gp(7), 4);
  leave_through_table(k);
}

}  // namespace kaz::h8s::translate
