// Emits loads and stores: memory inline; for everything else the block is left before the access.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>

#include "sim/h8s/translate/emitter.h"

namespace kaz::h8s::translate {
namespace {

// Distance of short RAM from kRamBase.
constexpr std::uint32_t kShortRamAt = kShortRam - kRam;

// Whether the step also writes the register that it accesses memory through otherwise: a value loaded, or
// one of several.
bool writes_pointer(const Step& s) {
  const Access a = access_of(s);
  if (s.form.op == Op::ldm) return s.form.first + s.form.count > a.reg;
  return s.form.op == Op::mov && s.form.dst == Mode::reg && s.insn.rd / 4u == a.reg;
}

}  // namespace

Place place_of(const Cpu& c, std::uint32_t address, unsigned size) {
  address &= c.mask;
  if (size > 1 && (address & 1)) return Place::elsewhere;
  const auto inside = [&](std::uint32_t offset, std::uint32_t length) {
    return offset < length && length - offset >= size;
  };
  if (inside(address - c.ram_base, c.ram_size)) return Place::ram;
  if (inside(address, c.flash_size)) return Place::flash;
  const std::uint32_t block = c.mask & kBlock;
  if (c.ram_size != 0 && inside(address - block - kShortRam, kShortRamSize))
    return Place::short_ram;
  return Place::elsewhere;
}

host::Mem Emitter::flag(std::size_t offset, unsigned size) const {
  return host::ptr(kCpu, static_cast<std::int32_t>(offset), size);
}

// Loads a word or long word with the bytes in reverse order for the host.
void Emitter::fetch_big(const host::Gp& to, const host::Mem& at, unsigned size) {
  host::Mem from = at;
  from.setSize(size);
  if (size == 1) {
    a_.movzx(to.r32(), from);
  } else if (movbe_) {
    a_.movbe(sized(to, size), from);
  } else if (size == 2) {
    a_.movzx(to.r32(), from);
    a_.rol(to.r16(), 8);
  } else {
    a_.mov(to.r32(), from);
    a_.bswap(to.r32());
  }
}

void Emitter::store_big(const host::Mem& at, const host::Gp& from, unsigned size) {
  host::Mem to = at;
  to.setSize(size);
  if (size == 1) {
    a_.mov(to, from.r8());
  } else if (movbe_) {
    a_.movbe(to, sized(from, size));
  } else {
    if (from.id() != host::edi.id()) a_.mov(host::edi, from.r32());
    if (size == 2)
      a_.rol(host::di, 8);
    else
      a_.bswap(host::edi);
    a_.mov(to, sized(host::edi, size));
  }
}

// esi holds the offset from the beginning of RAM; `bytes` from there must all be in it. Words: esi is
// halved, an odd address becomes an offset far beyond the end. The address is only masked if it is not in
// RAM without that.
host::Mem Emitter::ram_check(unsigned size, std::uint32_t bytes, const asmjit::Label& outside) {
  using host::esi;
  const std::uint32_t end = size == 1              ? c_.ram_size
                            : c_.ram_size >= bytes ? (c_.ram_size - (bytes - 2)) / 2
                                                   : 0;
  const asmjit::Label masked = a_.newLabel(), inside = a_.newLabel();
  if (size > 1) a_.ror(esi, 1);
  a_.cmp(esi, end);
  a_.jae(masked);
  a_.bind(inside);
  cold_.push_back([this, size, end, masked, inside, outside] {
    a_.bind(masked);
    if (size > 1) a_.rol(esi, 1);
    a_.and_(esi, c_.mask);
    if (size > 1) a_.ror(esi, 1);
    a_.cmp(esi, end);
    a_.jb(inside);
    a_.jmp(outside);
  });
  return size == 1 ? host::ptr(kRamBase, host::rsi, 0, 0, 1)
                   : host::ptr(kRamBase, host::rsi, 1, 0, size);
}

// Computes the address: esi becomes its offset in RAM, not masked, or `at` is known at translation time.
Place Emitter::address(const Step& s, Mode mode, unsigned reg, unsigned size, std::uint32_t bytes,
                       host::Mem& at) {
  if (mode == Mode::absolute) {
    const std::uint32_t address = s.insn.imm & c_.mask;
    const Place place = place_of(c_, address, size);
    if (place == Place::ram)
      at = host::ptr(kRamBase, static_cast<std::int32_t>(address - c_.ram_base));
    if (place == Place::short_ram) {
      const std::uint32_t from_short = address - (c_.mask & kBlock) - kShortRam;
      at = host::ptr(kRamBase, static_cast<std::int32_t>(kShortRamAt + from_short));
    }
    if (place == Place::flash) {
      a_.mov(host::r15, reinterpret_cast<std::uint64_t>(c_.flash));
      at = host::ptr(host::r15, static_cast<std::int32_t>(address));
    }
    at.setSize(size);
    return place;
  }
  std::uint32_t displacement = 0u - c_.ram_base;
  if (mode == Mode::indirect) displacement += s.insn.imm;
  if (mode == Mode::decrement) displacement -= bytes;
  a_.lea(host::esi, host::ptr(gp(reg).r64(), static_cast<std::int32_t>(displacement)));
  return Place::elsewhere;
}

// One check for this access and the later ones through the same register, if there are any.
bool Emitter::check_together(std::size_t k) {
  using host::esi;
  constexpr std::int32_t farthest = 0x1000;
  const auto near = [](const Access& a) {
    return a.displacement >= -farthest && a.displacement <= farthest;
  };
  const Access own = access_of(block_->steps[k]);
  if (!near(own)) return false;
  std::int32_t low = own.displacement, high = low + own.bytes, moved = 0;
  unsigned accesses = 1;
  bool words = own.words;
  for (std::size_t j = k; j < block_->steps.size(); ++j) {
    const Step& s = block_->steps[j];
    const Access a = access_of(s);
    const bool through = a.bytes != 0 && a.reg == own.reg;
    if (j != k && through) {
      if (!near(a) || moved < -farthest || moved > farthest) break;
      low = std::min(low, moved + a.displacement);
      high = std::max(high, moved + a.displacement + a.bytes);
      words = words || a.words;
      ++accesses;
    }
    if (!(registers_written_by(s) >> own.reg & 1)) continue;
    if (!through || a.moves == 0 || writes_pointer(s)) break;
    moved += a.moves;
  }
  if (accesses < 2) return false;
  if (words) low &= ~1, high = (high + 1) & ~1;
  const std::uint32_t span = static_cast<std::uint32_t>(high - low);
  if (span > c_.ram_size) return false;
  const asmjit::Label again = again_[k] = a_.newLabel();
  a_.lea(esi, host::ptr(gp(own.reg).r64(), low - static_cast<std::int32_t>(c_.ram_base)));
  if (words) a_.ror(esi, 1);
  a_.cmp(esi, words ? (c_.ram_size - span) / 2 + 1 : c_.ram_size - span + 1);
  a_.jae(again);
  proofs_[own.reg] = {low, high, words};
  return true;
}

std::optional<host::Mem> Emitter::proved(std::size_t k, unsigned size) {
  // The flat machine's addresses wrap.
  if (second_ || c_.flat || c_.observed || c_.ram_size == 0) return std::nullopt;
  const Step& s = block_->steps[k];
  const Access a = access_of(s);
  if (a.bytes == 0) return std::nullopt;
  // A pointer that is stored through itself is decremented before the store.
  if (s.form.op == Op::mov && s.form.dst == Mode::decrement && s.insn.rs / 4u == a.reg)
    return std::nullopt;
  const auto known = [&] {
    const Proof& p = proofs_[a.reg];
    return a.displacement >= p.low && std::int64_t{a.displacement} + a.bytes <= p.high &&
           p.low < p.high && (!a.words || (p.even && a.displacement % 2 == 0));
  };
  if (!known() && (!check_together(k) || !known())) return std::nullopt;
  return host::ptr(kRamBase, gp(a.reg).r64(), 0,
                   a.displacement - static_cast<std::int32_t>(c_.ram_base), size);
}

// After a step, for the next ones.
void Emitter::move_proofs(const Step& s) {
  const unsigned written = registers_written_by(s);
  const Access a = access_of(s);
  for (unsigned reg = 0; reg < 8; ++reg) {
    if (!(written >> reg & 1)) continue;
    Proof& p = proofs_[reg];
    if (a.bytes == 0 || a.reg != reg || a.moves == 0 || writes_pointer(s)) {
      p = {};
      continue;
    }
    p.low -= a.moves;
    p.high -= a.moves;
    if (a.moves % 2 != 0) p.even = false;
  }
}

// Runs `fetch` with the operand's place, in RAM or, but for the stack, in flash.
void Emitter::load(std::size_t k, Mode mode, unsigned reg, unsigned size, const Fetch& fetch) {
  const Step& s = block_->steps[k];
  if (const auto place = proved(k, size)) return fetch(*place);
  host::Mem at;
  if (address(s, mode, reg, size, size, at) != Place::elsewhere) return fetch(at);
  const bool stack = reg == 7 && mode == Mode::increment;
  const asmjit::Label out = before(k);
  if (stack || c_.flash_size == 0) return fetch(ram_check(size, size, out));
  const asmjit::Label outside = a_.newLabel(), done = a_.newLabel();
  fetch(ram_check(size, size, outside));
  a_.bind(done);
  cold_.push_back([this, size, fetch, out, outside, done] {
    using host::esi;
    a_.bind(outside);
    if (size > 1) a_.rol(esi, 1);
    a_.add(esi, c_.ram_base);
    a_.and_(esi, c_.mask);
    if (size > 1) {
      a_.test(esi, 1);
      a_.jnz(out);
    }
    a_.cmp(esi, c_.flash_size - (size == 4 ? 2 : 0));
    a_.jae(out);
    a_.mov(host::r15, reinterpret_cast<std::uint64_t>(c_.flash));
    fetch(host::ptr(host::r15, host::rsi, 0, 0, size));
    a_.jmp(done);
  });
}

// The operand's location in RAM, in lines without decoded instructions; while no line has any, there is no
// need to look. Uses esi and edi.
host::Mem Emitter::writable(std::size_t k, Mode mode, unsigned reg, unsigned size,
                            std::uint32_t bytes) {
  const Step& s = block_->steps[k];
  if (!c_.code_in_ram) {
    if (const auto place = proved(k, size)) return *place;
  }
  const asmjit::Label out = before(k);
  const unsigned lines = size == 1 ? 1 : 2;  // an operand may reach into the next line
  // The flags of lines that hold code, from the first line of RAM on.
  constexpr auto flags_at = static_cast<std::int32_t>(offsetof(Cpu, chip_lines) + kRam / kLine);
  const host::Mem elsewhere = host::ptr(kCpu, static_cast<std::int32_t>(offsetof(Cpu, has_code)));
  host::Mem at;
  if (address(s, mode, reg, size, bytes, at) != Place::elsewhere) {
    if (!c_.code_in_ram) return at;
    constexpr auto line = static_cast<std::int32_t>(kLine);
    const auto offset = static_cast<std::int32_t>(at.offset());
    const unsigned span = offset % line + static_cast<std::int32_t>(size) > line ? 2 : 1;
    if (c_.flat) a_.mov(host::rdi, elsewhere);
    a_.cmp(c_.flat ? host::ptr(host::rdi, offset / line, span)
                   : host::ptr(kCpu, flags_at + offset / line, span),
           0);
    a_.jne(out);
    return at;
  }
  at = ram_check(size, bytes, out);
  if (!c_.code_in_ram) return at;
  a_.mov(host::edi, host::esi);
  a_.shr(host::edi, size == 1 ? 6 : 5);
  const unsigned span = bytes > 2 ? lines : 1;
  if (c_.flat) a_.add(host::rdi, elsewhere);
  a_.cmp(c_.flat ? host::ptr(host::rdi, 0, span) : host::ptr(kCpu, host::rdi, 0, flags_at, span),
         0);
  a_.jne(out);
  return at;
}

// r15: the value stored; edi: the value loaded.
void Emitter::emit_access(std::size_t k, const void* gate) {
  const Step& s = block_->steps[k];
  a_.mov(host::rdi, reinterpret_cast<std::uint64_t>(c_.code + s.index));
  a_.mov(host::rsi, static_cast<std::int64_t>(block_->bound) -
                        static_cast<std::int64_t>(states_before(k + 1)));
  a_.call(asmjit::Imm(reinterpret_cast<std::uint64_t>(gate)));
}

void Emitter::load_io(std::size_t k) {
  emit_access(k, block_->steps[k].form.size == 1 ? gate_.load8 : gate_.load16);
}

void Emitter::store_io(std::size_t k) {
  emit_access(k, block_->steps[k].form.size == 1 ? gate_.store8 : gate_.store16);
}

void Emitter::emit_load(std::size_t k) {
  const Step& s = block_->steps[k];
  const unsigned size = s.form.size, pointer = s.insn.rs / 4;
  const Part to = part_at(s.insn.rd, size);
  if (s.io) {
    load_io(k);
    put(to, host::edi);
    return;
  }
  if (s.form.src != Mode::increment) {
    load(k, s.form.src, pointer, size, [this, to](const host::Mem& at) {
      if (to.shift != 0) {
        fetch_big(host::edi, at, to.size);
        put(to, host::edi);
      } else if (to.size == 1) {
        a_.mov(low(to.reg, 1), at);
      } else if (to.size == 2 && !movbe_) {
        fetch_big(host::edi, at, 2);
        put(to, host::edi);
      } else {
        fetch_big(gp(to.reg), at, to.size);
      }
    });
    return;
  }
  load(k, s.form.src, pointer, size,
       [this, size](const host::Mem& at) { fetch_big(host::edi, at, size); });
  a_.add(gp(pointer), size);
  put(to, host::edi);
}

void Emitter::emit_store(std::size_t k) {
  const Step& s = block_->steps[k];
  const unsigned size = s.form.size, pointer = s.insn.rd / 4;
  const Part from = part_at(s.insn.rs, size);
  if (s.io) {
    get(host::r15d, from);
    return store_io(k);
  }
  const bool down = s.form.dst == Mode::decrement;
  const bool overlaps = down && from.reg == pointer;
  const bool decremented = overlaps && c_.predecrement_stores_decremented;
  const host::Mem at = writable(k, s.form.dst, pointer, size, size);
  if (decremented) a_.sub(gp(pointer), size);
  if (from.shift == 0) {
    store_big(at, gp(from.reg), size);
  } else {
    get(host::edi, from);
    store_big(at, host::edi, size);
  }
  if (!down || decremented) return;
  // The flags are those of the value before the decrement, which is about to be overwritten.
  if (overlaps && (s.keep & (kN | kZ | kV))) {
    store_flags(s.definition, s.keep & (kN | kZ | kV));
    stored_ |= kN | kZ | kV;
  }
  a_.sub(gp(pointer), size);
}

// LDM and STM: the lowest register is at the highest address.
void Emitter::emit_multiple(std::size_t k) {
  const Step& s = block_->steps[k];
  const bool store = s.form.op == Op::stm;
  const std::uint32_t bytes = 4u * s.form.count;
  host::Mem at;
  if (store) {
    at = writable(k, Mode::decrement, 7, 4, bytes);
  } else if (const auto place = proved(k, 4)) {
    at = *place;
  } else {
    address(s, Mode::increment, 7, 4, bytes, at);
    at = ram_check(4, bytes, before(k));
  }
  for (unsigned n = 0; n < s.form.count; ++n) {
    const host::Gp r = gp(s.form.first + n);
    const host::Mem place = at.cloneAdjusted(static_cast<std::int64_t>(bytes - 4 - 4 * n));
    if (store)
      store_big(place, r, 4);
    else
      fetch_big(r, place, 4);
  }
  if (store)
    a_.sub(gp(7), bytes);
  else
    a_.add(gp(7), bytes);
}

}  // namespace kaz::h8s::translate
