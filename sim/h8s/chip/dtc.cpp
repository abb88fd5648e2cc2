// Data transfer controller: registers, modes and timing (hardware manual, DTC).
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/dtc.h"

#include <algorithm>
#include <utility>

#include "sim/h8s/chip/machine.h"
#include "sim/h8s/cpu/access.h"

namespace kaz::h8s {
namespace {

constexpr std::uint32_t kVectors = 0x0400;
constexpr std::uint32_t kFirstBlock = 0xec00, kLastBlock = 0xf000 - 12;

// Vectors by register and bit, bit 7 first; 0: no such source on this chip.
constexpr std::uint8_t kActivations[5][8] = {{16, 17, 18, 0, 28, 48, 49, 52},
                                             {53, 0, 0, 0, 0, 64, 65, 68},
                                             {69, 72, 73, 0, 0, 81, 82, 85},
                                             {86, 0, 0, 0, 0, 0, 0, 0},
                                             {0, 0, 0, 0, 0, 0, 0, 0}};

struct Enable {
  unsigned reg = 0;
  std::uint8_t mask = 0;
};
Enable enable_of(unsigned vector) {
  for (unsigned r = 0; r < 5; ++r)
    for (unsigned k = 0; k < 8; ++k)
      if (kActivations[r][k] == vector) return {r, static_cast<std::uint8_t>(DTCER::DTCE7 >> k)};
  return {};
}

}  // namespace

struct Dtc::Block {
  std::uint8_t mra = 0, mrb = 0;
  std::uint32_t sar = 0, dar = 0;
  std::uint16_t cra = 0, crb = 0;

  explicit Block(const std::uint8_t* p)
      : mra(p[0]),
        mrb(p[4]),
        sar(big32(p) & 0xffffff),
        dar(big32(p + 4) & 0xffffff),
        cra(big16(p + 8)),
        crb(big16(p + 10)) {}
  void put(std::uint8_t* p) const {
    put_big32(p, std::uint32_t{mra} << 24 | (sar & 0xffffff));
    put_big32(p + 4, std::uint32_t{mrb} << 24 | (dar & 0xffffff));
    put_big16(p + 8, cra);
    put_big16(p + 10, crb);
  }
  bool word() const { return (mra & MRA::SZ) != 0; }
  bool source_repeats() const { return (mra & MRA::DTS) != 0; }
  unsigned mode() const { return field<MRA::MD>(mra); }
  std::uint32_t step(unsigned bits) const {
    const std::uint32_t size = word() ? 2 : 1;
    return bits < 2 ? 0 : bits == 2 ? size : 0 - size;
  }
  std::uint32_t source_step() const { return step(field<MRA::SM>(mra)); }
  std::uint32_t target_step() const { return step(field<MRA::DM>(mra)); }
  bool chained() const { return (mrb & MRB::CHNE) != 0; }
  bool always_interrupts() const { return (mrb & MRB::DISEL) != 0; }
  // At the end of `count` units the repeat or block area returns to its beginning.
  void rewind(std::uint32_t count) {
    if (source_repeats())
      sar -= count * source_step();
    else
      dar -= count * target_step();
  }
};

std::uint8_t Dtc::peek(std::uint32_t address) const {
  return address == io::DTVECR ? dtvecr_ : dtcer_[address - io::DTCERA];
}

std::uint8_t Dtc::read(std::uint32_t address) {
  if (address == io::DTVECR && (dtvecr_ & DTVECR::SWDTE)) swdte_seen_ = true;
  return peek(address);
}

void Dtc::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  if (address != io::DTVECR) {
    const unsigned r = address - io::DTCERA;
    for (unsigned k = 0; k < 8; ++k)
      if ((value & DTCER::DTCE7 >> k) && kActivations[r][k] == 0)
        m.misuse(address, "DTC enabled for an interrupt source that the H8S/2128 does not have");
    dtcer_[r] = value;
    divert(m);
    return;
  }
  const bool active = (dtvecr_ & DTVECR::SWDTE) != 0;
  if (active) {
    // The vector number stays; SWDTE is cleared by writing 0 after it has been read as 1.
    if ((value & DTVECR::DTVEC) != (dtvecr_ & DTVECR::DTVEC))
      m.misuse(address, "DTVEC changed while SWDTE is set; the change has no effect");
    if (!(value & DTVECR::SWDTE) && swdte_seen_) {
      dtvecr_ &= DTVECR::DTVEC;
      swdte_seen_ = ended_ = false;
      m.irq.set(vec::kSwdtend, false, at);
    }
    return;
  }
  dtvecr_ = value;
  ended_ = swdte_seen_ = false;
  software_at_ = at;
}

void Dtc::divert(Machine& m) {
  std::array<std::uint64_t, 2> mask{};
  for (unsigned r = 0; r < 5; ++r) {
    for (unsigned k = 0; k < 8; ++k) {
      const unsigned v = kActivations[r][k];
      if (v != 0 && (dtcer_[r] & DTCER::DTCE7 >> k)) mask[v / 64] |= 1ull << (v % 64);
    }
  }
  m.irq.divert(mask, m.time());
}

States Dtc::earliest(const Machine& m) const {
  if (m.stopped(kStopDtc)) return kNever;
  const int decision = m.options.dtc_decision_states;
  States at = m.irq.diverted_since();
  if (at != kNever) at += decision + 1;
  if (!idle()) at = std::min(at, software_at_ + decision + 1);
  return at;
}

bool Dtc::run(Machine& m) {
  if (earliest(m) > m.cpu.now) return false;
  const States limit = m.cpu.now - m.options.dtc_decision_states - 1;
  const unsigned vector = m.irq.first_diverted(limit);
  rdr_read_ = tdr_written_ = {};
  result_read_ = false;
  if (vector != 0) {
    const Outcome o = serve(m, vector);
    const Enable e = enable_of(vector);
    if (o.ended) {
      dtcer_[e.reg] = static_cast<std::uint8_t>(dtcer_[e.reg] & ~e.mask);
      divert(m);
    } else {
      release(m, vector);
    }
  } else {
    const unsigned number = dtvecr_ & DTVECR::DTVEC;
    const Outcome o = serve(m, number);
    if (o.ended) {
      ended_ = true;
      m.irq.set(vec::kSwdtend, true, m.time());
    } else {
      dtvecr_ &= DTVECR::DTVEC;
      swdte_seen_ = false;
    }
  }
  return true;
}

// One activation with all transfers chained to it.
Dtc::Outcome Dtc::serve(Machine& m, unsigned vector) {
  Cpu& c = m.cpu;
  std::uint32_t at = load16(c, kVectors + 2 * vector);
  c.now += 1;
  Outcome outcome{true, false};
  for (int chained = 0;; ++chained) {
    std::uint8_t* p =
        at >= kFirstBlock && at <= kLastBlock ? m.memory_at((c.mask & 0xff0000) | at) : nullptr;
    if (!p || (at & 1) || c.ram_size == 0) {
      m.misuse(kVectors + 2 * vector,
               "DTC register information has an odd address or lies outside FFEC00 to FFEFFF, or "
               "RAM is off");
      return outcome;
    }
    Block b(p);
    // Reading the register information: half of its accesses.
    c.now += m.options.dtc_register_accesses / 2;
    if (b.mode() == 3) m.misuse((c.mask & 0xff0000) | at, "DTC mode 3 does not exist");
    const bool end = transfer(m, b);
    b.put(p);
    m.forget_code_at((c.mask & 0xff0000) | at);
    for (std::uint32_t k = 0; k < 12; k += 2) note_ram_write(c, (at + k) % 0x2000);
    c.now += m.options.dtc_register_accesses - m.options.dtc_register_accesses / 2;
    if (!b.chained()) {
      outcome = {end || b.always_interrupts(), true};
      break;
    }
    at += 12;
    // At most as many chained blocks as fit into the area; a last block that still chains ends there.
    if (chained > 256) return outcome;
  }
  c.now += m.options.dtc_internal_states + c.stall;
  c.stall = 0;
  return outcome;
}

bool Dtc::transfer(Machine& m, Block& b) {
  if (b.mode() == 1) {
    move(m, b);
    const auto left = static_cast<std::uint8_t>((b.cra & 0xff) - 1);
    b.cra = static_cast<std::uint16_t>((b.cra & 0xff00) | left);
    if (left == 0) {
      const unsigned size = b.cra >> 8;
      b.rewind(size == 0 ? 256 : size);
      b.cra = static_cast<std::uint16_t>(size << 8 | size);
    }
    return false;
  }
  if (b.mode() == 2) {
    const unsigned size = b.cra >> 8, count = size == 0 ? 256 : size;
    for (unsigned k = 0; k < count; ++k) move(m, b);
    b.rewind(count);
    b.cra = static_cast<std::uint16_t>(size << 8 | size);
    return --b.crb == 0;
  }
  move(m, b);
  return --b.cra == 0;
}

// One unit, through the same buses and registers as the CPU's accesses.
void Dtc::move(Machine& m, Block& b) {
  Cpu& c = m.cpu;
  const auto serial = [](std::uint32_t address, unsigned n, std::uint32_t offset) {
    return (address & 0xffff) == (n == 0 ? io::SMR0 : io::SMR1) + offset;
  };
  for (unsigned n = 0; n < 2; ++n) {
    rdr_read_[n] |= serial(b.sar, n, Sci::kRdr);
    tdr_written_[n] |= serial(b.dar, n, Sci::kTdr);
  }
  result_read_ |= (b.sar & 0xffff) - io::ADDRA < io::ADCSR - io::ADDRA;
  c.now += 1;
  if (b.word())
    store16(c, b.dar, (c.now += 1, load16(c, b.sar)));
  else
    store8(c, b.dar, (c.now += 1, load8(c, b.sar)));
  b.sar = (b.sar + b.source_step()) & 0xffffff;
  b.dar = (b.dar + b.target_step()) & 0xffffff;
}

// The request has been served: clears its flag as the manual specifies for each source.
void Dtc::release(Machine& m, unsigned vector) {
  const States at = m.time();
  switch (vector) {
    case vec::kAdi:
      if (result_read_) m.adc.taken_by_dtc(m, at);
      m.rescheduled(Source::adc);
      break;
    case vec::kEri0 + 1:
    case vec::kEri1 + 1: {
      const unsigned n = vector == vec::kEri0 + 1 ? 0 : 1;
      if (rdr_read_[n]) m.sci[n].taken_by_dtc(m, n, at);
      break;
    }
    case vec::kEri0 + 2:
    case vec::kEri1 + 2: {
      const unsigned n = vector == vec::kEri0 + 2 ? 0 : 1;
      if (tdr_written_[n]) m.sci[n].filled_by_dtc(m, n, at);
      m.rescheduled(n == 0 ? Source::sci0 : Source::sci1);
      break;
    }
    case vec::kIcia:
    case vec::kIcia + 1:
    case vec::kOcia:
    case vec::kOcib:
      m.frt.taken_by_dtc(m, vector, at);
      m.rescheduled(Source::frt);
      break;
    default:
      if (vector >= vec::kCmiay) {
        m.tmr_xy.taken_by_dtc(m, vector, at);
        m.rescheduled(Source::tmr_xy);
      } else if (vector >= vec::kCmia0) {
        m.tmr.taken_by_dtc(m, vector, at);
        m.rescheduled(Source::tmr);
      } else {
        m.irq.taken_by_dtc(vector, at);
      }
      break;
  }
}

}  // namespace kaz::h8s
