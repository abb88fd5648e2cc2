// TMRX and TMRY: clocks, pulse measurement, registers; the timer connection's control registers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/tmr_xy.h"

#include <algorithm>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {

States TmrXY::divisor(unsigned n) const {
  constexpr States table[2][4] = {{0, 1, 2, 4}, {0, 4, 256, 2048}};
  const unsigned cks = timer_[n].clock_select();
  return cks > 3 ? 0 : table[n][cks];
}

void TmrXY::update(Machine& m, States at) {
  const unsigned active = timer_[kY].requests();
  const bool measured = timer_[kX].flags.has(TMR_TCSR::ICF) && icie_;
  m.irq.set_all(vec::kCmiay, 4,
                (active & TMR_TCSR::CMFA ? 1u : 0u) | (active & TMR_TCSR::CMFB ? 2u : 0u) |
                    (active & TMR_TCSR::OVF ? 4u : 0u) | (measured ? 8u : 0u),
                at);
}

void TmrXY::step(Machine& m, unsigned n, std::int64_t counts, States at) {
  timer_[n].step(counts);
  update(m, at);
}

void TmrXY::advance_one(Machine& m, unsigned n, States to) {
  const States d = divisor(n);
  if (d == 0) return;
  Timer8& t = timer_[n];
  const States target = (to - m.epoch) / d;
  while (t.tick < target) {
    const std::int64_t counts = std::min(t.to_next(), target - t.tick);
    t.tick += counts;
    const std::uint8_t before = t.flags.value();
    step(m, n, counts, m.epoch + t.tick * d);
    if (before == t.flags.value()) t.skip_turns(target);
  }
}

void TmrXY::advance(Machine& m, States to) {
  if (!m.stopped(kStopTmrxy)) {
    advance_one(m, kX, to);
    advance_one(m, kY, to);
    return;
  }
  for (unsigned n = 0; n < 2; ++n) {
    if (const States d = divisor(n)) timer_[n].tick = (to - m.epoch) / d;
  }
}

// Only TMRY's matches and overflow can interrupt. A clear may come first, so each crossing is checked.
States TmrXY::next_event(const Machine& m) const {
  const Timer8& t = timer_[kY];
  const States d = divisor(kY);
  if (d == 0 || (t.tcr & ~t.flags.value() & Timer8::kFlags) == 0) return kNever;
  return m.epoch + (t.tick + t.to_next()) * d;
}

States TmrXY::next_change(const Machine& m) const {
  const States d = divisor(kX);
  const std::int64_t counts = timer_[kX].to_next_change();
  return d == 0 || counts == kNever ? kNever : m.epoch + (timer_[kX].tick + counts) * d;
}

// TCONRI.ICST arms one measurement: the rising edge into TICRR, the falling one after it into TICRF.
void TmrXY::capture(bool rising) {
  if (!(tconri_ & TCONRI::ICST)) return;
  if (rising) {
    ticrr_ = timer_[kX].count;
    rose_ = true;
  } else if (rose_) {
    ticrf_ = timer_[kX].count;
    rose_ = false;
    tconri_ &= ~TCONRI::ICST;
    timer_[kX].flags.raise(TMR_TCSR::ICF);
  }
}

void TmrXY::pin_edge(Machine& m, unsigned n, bool rising, States at) {
  if (m.stopped(kStopTmrxy) || (n == kY && !(tisr_ & TISR::IS))) return;
  advance(m, at);
  if (timer_[n].counts_edge(rising)) timer_[n].step(1);
  if (n == kX) capture(rising);
  if (rising && timer_[n].clear() == Timer8::Clear::on_pin) timer_[n].count = 0;
  update(m, at);
}

bool TmrXY::waits_for_input() const {
  return (timer_[kY].waits_for_clock() && (tisr_ & TISR::IS)) ||
         (icie_ && (tconri_ & TCONRI::ICST));
}

std::uint8_t TmrXY::peek(std::uint32_t address) const {
  const Timer8& t = timer_[bank_y() ? kY : kX];
  switch (address) {
    case io::TCRX:
      return t.tcr;
    case io::TCSRX:
      return t.flags.value() | t.tcsr_low | (bank_y() && icie_ ? TMR_TCSR::ICIE : 0);
    case io::TICRR:
      return bank_y() ? t.tcora : ticrr_;
    case io::TICRF:
      return bank_y() ? t.tcorb : ticrf_;
    case io::TCNTX:
      return t.count;
    case io::TCORC:
      return bank_y() ? tisr_ : tcorc_;
    case io::TCORAX:
      return timer_[kX].tcora;
    case io::TCORBX:
      return timer_[kX].tcorb;
    case io::TCONRI:
      return tconri_;
    case io::TCONRO:
      return tconro_;
    case io::TCONRS:
      return tconrs_;
    default:
      return sedgr_;
  }
}

std::uint8_t TmrXY::read(Machine& m, std::uint32_t address, States at) {
  advance(m, at);
  if (address == io::TCSRX) timer_[bank_y() ? kY : kX].flags.read();
  return peek(address);
}

void TmrXY::write_timer(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  const unsigned n = bank_y() ? kY : kX;
  Timer8& t = timer_[n];
  if (n == kX && (address == io::TICRR || address == io::TICRF)) {
    m.misuse(address, "write to an input capture register of TMRX, which is read-only");
    return;
  }
  advance(m, at - 1);  // in the state of the write itself the write wins
  std::uint8_t* const compare = address == (n == kX ? io::TCORAX : io::TCORAY)   ? &t.tcora
                                : address == (n == kX ? io::TCORBX : io::TCORBY) ? &t.tcorb
                                                                                 : nullptr;
  if (compare) *compare = static_cast<std::uint8_t>(~t.count);
  if (address != io::TCNTX) advance(m, at);
  const bool drove = drives();
  switch (address) {
    case io::TCRX:
      t.tcr = value;
      break;
    case io::TCSRX:
      t.flags.write(
          static_cast<std::uint8_t>(n == kX ? value | TMR_TCSR::OS : value | ~Timer8::kFlags));
      t.tcsr_low = value & TMR_TCSR::OS;
      if (n == kY) icie_ = (value & TMR_TCSR::ICIE) != 0;
      break;
    case io::TCNTX:
      t.count = value;
      break;
    case io::TCORC:
      if (n == kX)
        tcorc_ = value;
      else
        tisr_ = value | TISR::ONE;
      break;
    default:
      if (compare)
        *compare = value;
      else
        m.misuse(address, "write to an address without a register while TCONRS.TMRX/Y is 1");
      break;
  }
  if (const States d = divisor(n)) t.tick = (at - m.epoch) / d;
  if (n == kX && (drove || drives())) m.notify(OutputChange::Unit::port, 6, at);
}

void TmrXY::write_connection(Machine& m, std::uint32_t address, std::uint8_t value) {
  switch (address) {
    case io::TCONRI:
      if (value & ~TCONRI::ICST)
        m.misuse(address,
                 "TCONRI enables the timer connection, whose signal paths are not emulated");
      if (value & TCONRI::ICST & ~tconri_) rose_ = false;
      tconri_ = value;
      break;
    case io::TCONRO:
      if (value & (TCONRO::HOE | TCONRO::VOE | TCONRO::CLOE | TCONRO::CBOE))
        m.misuse(address,
                 "TCONRO enables a sync output of the timer connection, which is not emulated");
      tconro_ = value;
      break;
    case io::TCONRS:
      if (value & ~TCONRS::TMRXY)
        m.misuse(address,
                 "TCONRS selects sync signals of the timer connection, which are not emulated");
      tconrs_ = value;
      break;
    default:
      // Flags, none of which rises here.
      sedgr_ &= value & ~(SEDGR::IHI | SEDGR::IVI);
      break;
  }
}

void TmrXY::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  if (address >= io::TCONRI)
    write_connection(m, address, value);
  else
    write_timer(m, address, value, at);
  update(m, at);
}

}  // namespace kaz::h8s
