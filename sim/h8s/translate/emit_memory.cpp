// Emits loads and stores: memory inline; for everything else the block is left before the access.
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>

#include "sim/h8s/translate/emitter.h"

namespace kaz::h8s::translate {
namespace {

// Distance of short RAM from kRamBase.
constexpr std::uint32_t kShortRamAt = kShortRam - kRam;

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
// halved, an odd address becomes an offset far beyond the end.
host::Mem Emitter::ram_check(unsigned size, std::uint32_t bytes, const asmjit::Label& outside) {
  using host::esi;
  if (size == 1) {
    a_.cmp(esi, c_.ram_size);
    a_.jae(outside);
    return host::ptr(kRamBase, host::rsi, 0, 0, 1);
  }
  a_.ror(esi, 1);
  a_.cmp(esi, c_.ram_size >= bytes ? (c_.ram_size - (bytes - 2)) / 2 : 0);
  a_.jae(outside);
  return host::ptr(kRamBase, host::rsi, 1, 0, size);
}

// Computes the address: esi becomes its offset in RAM, or `at` is known at translation time.
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
  a_.and_(host::esi, c_.mask);
  return Place::elsewhere;
}

// Runs `fetch` with the operand's place, in RAM or, but for the stack, in flash.
void Emitter::load(std::size_t k, Mode mode, unsigned reg, unsigned size, const Fetch& fetch) {
  const Step& s = block_->steps[k];
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

// The operand's location in RAM, in lines without decoded instructions. Uses esi and edi.
host::Mem Emitter::writable(std::size_t k, Mode mode, unsigned reg, unsigned size,
                            std::uint32_t bytes) {
  const Step& s = block_->steps[k];
  const asmjit::Label out = before(k);
  const unsigned lines = size == 1 ? 1 : 2;  // an operand may reach into the next line
  // The flags of lines that hold code, from the first line of RAM on.
  constexpr auto flags_at = static_cast<std::int32_t>(offsetof(Cpu, chip_lines) + kRam / kLine);
  const host::Mem elsewhere = host::ptr(kCpu, static_cast<std::int32_t>(offsetof(Cpu, has_code)));
  host::Mem at;
  if (address(s, mode, reg, size, bytes, at) != Place::elsewhere) {
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
  a_.mov(host::edi, host::esi);
  a_.shr(host::edi, size == 1 ? 6 : 5);
  const unsigned span = bytes > 2 ? lines : 1;
  if (c_.flat) a_.add(host::rdi, elsewhere);
  a_.cmp(c_.flat ? host::ptr(host::rdi, 0, span) : host::ptr(kCpu, host::rdi, 0, flags_at, span),
         0);
  a_.jne(out);
  return at;
}

void Emitter::emit_load(std::size_t k) {
  const Step& s = block_->steps[k];
  const unsigned size = s.form.size, pointer = s.insn.rs / 4;
  const Part to = part_at(s.insn.rd, size);
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
