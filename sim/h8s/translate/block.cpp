// Steps of a block, and the liveness of their flags.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/translate/block.h"

#include "sim/h8s/cpu/flags.h"

namespace kaz::h8s::translate {
namespace {

constexpr unsigned kNzv = kN | kZ | kV;

unsigned registers_read_by(const Definition& d) {
  switch (d.from) {
    case From::nothing:
    case From::zero:
      return 0;
    case From::result:
    case From::neg:
    case From::bit:
      return 1u << d.r.reg;
    default:
      return 1u << d.r.reg | (d.immediate ? 0u : 1u << d.b.reg);
  }
}

}  // namespace

unsigned registers_written_by(const Step& s) {
  const unsigned rs = 1u << s.insn.rs / 4, rd = 1u << s.insn.rd / 4, sp = 1u << 7;
  switch (s.form.op) {
    case Op::mov: {
      unsigned mask = s.form.dst == Mode::reg ? rd : 0;
      if (s.form.src == Mode::increment) mask |= rs;
      if (s.form.dst == Mode::decrement) mask |= rd;
      return mask;
    }
    case Op::nop:
    case Op::cmp:
    case Op::btst:
    case Op::bor:
    case Op::bxor:
    case Op::band:
    case Op::bld:
    case Op::bcc:
    case Op::jmp:
    case Op::control:
      return 0;
    case Op::bset:
    case Op::bnot:
    case Op::bclr:
    case Op::bst:
      return s.form.dst == Mode::reg ? rd : 0;
    case Op::bsr:
    case Op::jsr:
    case Op::rts:
    case Op::rte:
    case Op::stm:
      return sp;
    case Op::ldm:
      return sp | ((1u << s.form.count) - 1) << s.form.first;
    case Op::interpreted:
    case Op::handler:
      return 0xff;
    default:
      return rd;
  }
}

Access access_of(const Step& s) {
  const Form& form = s.form;
  const auto size = static_cast<std::int32_t>(form.size);
  const auto through = [&](Mode mode, unsigned reg, std::int32_t bytes, bool words) -> Access {
    switch (mode) {
      case Mode::indirect:
        return {reg, static_cast<std::int32_t>(s.insn.imm), bytes, 0, words};
      case Mode::increment:
        return {reg, 0, bytes, bytes, words};
      case Mode::decrement:
        return {reg, -bytes, bytes, -bytes, words};
      default:
        return {};
    }
  };
  switch (form.op) {
    case Op::mov:
      return form.dst == Mode::reg ? through(form.src, s.insn.rs / 4u, size, size > 1)
                                   : through(form.dst, s.insn.rd / 4u, size, size > 1);
    case Op::bset:
    case Op::bnot:
    case Op::bclr:
    case Op::bst:
    case Op::btst:
    case Op::bor:
    case Op::bxor:
    case Op::band:
    case Op::bld:
      return through(form.dst, s.insn.rd / 4u, 1, false);
    case Op::bsr:
    case Op::jsr:
      return through(Mode::decrement, 7, 4, true);
    case Op::rts:
    case Op::rte:
      return through(Mode::increment, 7, 4, true);
    case Op::stm:
      return through(Mode::decrement, 7, 4 * form.count, true);
    case Op::ldm:
      return through(Mode::increment, 7, 4 * form.count, true);
    default:
      return {};
  }
}

namespace {

bool may_exit_before(const Form& form) {
  const auto memory = [](Mode m) {
    return m == Mode::indirect || m == Mode::increment || m == Mode::decrement ||
           m == Mode::absolute;
  };
  switch (form.op) {
    case Op::stm:
    case Op::ldm:
    case Op::bsr:
    case Op::jsr:
    case Op::rts:
    case Op::rte:
    case Op::control:  // a request may be pending
      return true;
    case Op::jmp:
      return form.src == Mode::indirect;  // to a place without code
    case Op::interpreted:
      return false;
    default:
      return memory(form.src) || memory(form.dst);
  }
}

void two_operands(Step& s, From from, unsigned flags) {
  Definition& d = s.definition;
  d.from = from;
  d.r = part_at(s.insn.rd, s.form.size);
  d.immediate = s.form.src != Mode::reg;
  d.value = s.insn.imm;
  s.sets = s.recoverable = flags;
  if (d.immediate) return;
  d.b = part_at(s.insn.rs, s.form.size);
  if (!(d.b == d.r)) return;
  if (from == From::sub || from == From::cmp) d.from = From::zero;
  if (from == From::add) {
    d.from = From::result;  // V, H and C are gone with the old value
    s.recoverable = kN | kZ;
  }
}

void describe_flags(const Cpu& c, Step& s) {
  const Form& form = s.form;
  Definition& d = s.definition;
  const auto by_result = [&](unsigned sets, unsigned recoverable, unsigned size) {
    d.from = From::result;
    d.r = part_at(s.insn.rd, size);
    s.sets = sets;
    s.recoverable = recoverable;
  };
  switch (form.op) {
    case Op::mov: {
      by_result(kNzv, kNzv, form.size);
      if (form.dst == Mode::reg) break;
      d.r = part_at(s.insn.rs, form.size);
      // Except if the value stored is the register's value afterwards.
      if (form.dst == Mode::decrement && s.insn.rd / 4 == d.r.reg &&
          !c.predecrement_stores_decremented)
        s.recoverable = 0;
      break;
    }
    case Op::add:
      return two_operands(s, From::add, kAllFlags);
    case Op::sub:
      return two_operands(s, From::sub, kAllFlags);
    case Op::cmp:
      return two_operands(s, From::cmp, kAllFlags);
    case Op::bit_xor:
      if (form.src == Mode::reg && s.insn.rs == s.insn.rd) {
        d.from = From::zero;
        s.sets = s.recoverable = kNzv;
        break;
      }
      [[fallthrough]];
    case Op::bit_and:
    case Op::bit_or:
    case Op::bit_not:
    case Op::extu:
    case Op::exts:
      by_result(kNzv, kNzv, form.size);
      break;
    case Op::inc:
    case Op::dec:
      by_result(kNzv, kNzv, form.size);
      d.from = form.op == Op::inc ? From::add : From::sub;
      d.immediate = true;
      d.value = form.count;
      break;
    case Op::neg:
      by_result(kAllFlags, kAllFlags, form.size);
      d.from = From::neg;
      break;
    case Op::shift: {
      const bool signed_left = form.detail == static_cast<unsigned>(Shift::shal);
      by_result(kNzv | kC, signed_left ? kN | kZ : kNzv, form.size);
      if (form.detail == static_cast<unsigned>(Shift::rotxl) ||
          form.detail == static_cast<unsigned>(Shift::rotxr))
        s.uses = kC;
      break;
    }
    case Op::mulxs:
      by_result(kN | kZ, kN | kZ, form.size * 2u);
      break;
    case Op::addx:
    case Op::subx:
      s.sets = kAllFlags;
      s.uses = kZ | kC;
      break;
    case Op::btst:
      s.sets = kZ;
      if (form.dst == Mode::reg && !form.number_in_register) {
        d.from = From::bit;
        d.r = part_at(s.insn.rd, 1);
        d.value = 1u << s.insn.rs;
        s.recoverable = kZ;
      }
      break;
    case Op::bor:
    case Op::bxor:
    case Op::band:
      s.sets = s.uses = kC;
      break;
    case Op::bld:
      s.sets = kC;
      break;
    case Op::bst:
      s.uses = kC;
      break;
    case Op::handler:
    case Op::interpreted:
      s.sets = s.uses = kAllFlags;  // in memory before and after
      break;
    case Op::rte:
      s.sets = kAllFlags;
      break;
    default:
      break;
  }
}

// Bytes and words at registers of the chip, by MOV and the bit instructions.
bool accesses_register(const Cpu& c, const Step& s) {
  const std::uint32_t address = s.insn.imm;
  return c.bus && s.form.op != Op::interpreted && s.form.size <= 2 && is_io(c, address) &&
         (s.form.size == 1 || !(address & 1));
}

// False where the interpreter's handler has to run: unmapped addresses, long words at registers.
bool resolve_memory(const Cpu& c, Step& s) {
  const Form& form = s.form;
  const bool load = form.src == Mode::absolute, store = form.dst == Mode::absolute;
  if (form.op == Op::jmp || form.op == Op::jsr || (!load && !store)) return true;
  const Place place = place_of(c, s.insn.imm, form.size);
  if (place == Place::elsewhere) {
    s.io = accesses_register(c, s);
    return s.io;
  }
  const bool writes = store && (form.op == Op::mov || form.op == Op::bset || form.op == Op::bnot ||
                                form.op == Op::bclr || form.op == Op::bst);
  return !writes || place != Place::flash;
}

// Whether only the mask bits of CCR change.
bool keeps_flags(const Step& s) {
  constexpr std::uint32_t flags = 0x2f;
  return static_cast<Control>(s.form.detail) == Control::bit_and ? (s.insn.imm & flags) == flags
                                                                 : (s.insn.imm & flags) == 0;
}

std::uint32_t index_at(Cpu& c, std::uint32_t address) {
  const Insn* at = at_address(c, address);
  return at == &c.outside ? kNowhere : static_cast<std::uint32_t>(at - c.code);
}

}  // namespace

Part part_at(unsigned offset, unsigned size) {
  return {static_cast<std::uint8_t>(offset / 4), static_cast<std::uint8_t>(8 * (offset % 4)),
          static_cast<std::uint8_t>(size)};
}

unsigned flags_of_condition(unsigned condition) {
  switch (condition) {
    case 0x0:
    case 0x1:
      return 0;
    case 0x2:
    case 0x3:
      return kC | kZ;
    case 0x4:
    case 0x5:
      return kC;
    case 0x6:
    case 0x7:
      return kZ;
    case 0x8:
    case 0x9:
      return kV;
    case 0xa:
    case 0xb:
      return kN;
    case 0xc:
    case 0xd:
      return kN | kV;
    default:
      return kN | kV | kZ;
  }
}

bool take_step(Cpu& c, std::uint32_t index, Step& step) {
  const Decoded decoded = decode_at(c, index);
  if (!decoded.opcode) return false;
  step.form = form_of(*decoded.opcode);
  step.insn = decoded.insn;
  step.index = index;
  step.target = kNowhere;
  // A block that wraps around the top of the flat machine's memory is not translated.
  if (c.flat && index + step.insn.units > c.ram_size / 2) return false;
  if (step.form.op == Op::none) return false;
  if (!resolve_memory(c, step) || (step.form.op == Op::control && !keeps_flags(step))) {
    step.form = Form{};
    step.form.op = Op::interpreted;
  }
  const Op op = step.form.op;
  const std::uint32_t pc = pc_of(c, c.code + index);
  // Translated code is left before an instruction with a code hook, which Machine::run_hook calls.
  if (c.hooks && has_hook(c, pc)) return false;
  if (op == Op::bcc || op == Op::bsr)
    step.target = index_at(c, pc + 2u * step.insn.units + step.insn.imm);
  else if ((op == Op::jmp || op == Op::jsr) && step.form.src == Mode::absolute)
    step.target = index_at(c, step.insn.imm);
  else if (op != Op::jmp && op != Op::jsr)
    step.target = 0;
  else
    step.target = index;  // only known when it runs
  if (step.target == kNowhere) return false;
  step.exits = !step.io && may_exit_before(step.form);
  describe_flags(c, step);
  return true;
}

int common_source(const Block& block, std::size_t k, unsigned wanted) {
  int source = -1;
  for (int f = 0; f < kFlags; ++f) {
    if (!(wanted >> f & 1)) continue;
    const int by = block.steps[k].set_by[static_cast<std::size_t>(f)];
    if (by < 0 || (source >= 0 && by != source)) return -1;
    source = by;
  }
  if (source < 0) return -1;
  const Step& s = block.steps[static_cast<std::size_t>(source)];
  if ((s.recoverable & wanted) != wanted) return -1;
  const unsigned registers = registers_read_by(s.definition);
  for (std::size_t j = static_cast<std::size_t>(source) + 1; j < k; ++j) {
    if (registers_written_by(block.steps[j]) & registers) return -1;
  }
  return source;
}

void settle_flags(Block& block) {
  std::array<std::int16_t, kFlags> last;
  last.fill(-1);
  for (std::size_t k = 0; k < block.steps.size(); ++k) {
    Step& s = block.steps[k];
    s.set_by = last;
    if (s.form.op == Op::bcc) {
      const unsigned wanted = flags_of_condition(s.form.detail);
      if (wanted != 0 && common_source(block, k, wanted) < 0) s.uses = wanted;
    }
    for (std::size_t f = 0; f < kFlags; ++f) {
      if (s.sets >> f & 1) last[f] = static_cast<std::int16_t>(k);
    }
  }
  // A flag must be in memory where it is read from there, or where the block may be left after the
  // registers that it is computed from have changed.
  for (std::size_t i = 0; i < block.steps.size(); ++i) {
    Step& s = block.steps[i];
    const unsigned registers = registers_read_by(s.definition);
    unsigned open = s.sets;
    bool changed = false;
    const auto left_here = [&] { s.keep |= changed ? open : open & ~s.recoverable; };
    if (s.io) left_here();
    for (std::size_t k = i + 1; k < block.steps.size() && open != 0; ++k) {
      const Step& later = block.steps[k];
      s.keep |= later.uses & open;
      if (later.exits || later.form.op == Op::bcc) left_here();
      open &= ~later.sets;
      changed = changed || (registers_written_by(later) & registers) != 0;
      if (later.io) left_here();
    }
    left_here();
  }
  // Live at the entry: read, or the block may be left, before it is set.
  unsigned open = kAllFlags;
  for (const Step& s : block.steps) {
    block.live |= s.uses & open;
    if (s.exits || s.form.op == Op::bcc) block.live |= open;
    open &= ~s.sets;
    if (s.io) block.live |= open;
  }
  block.live |= open;
}

}  // namespace kaz::h8s::translate
