// Serial channel: double-buffered transmission, reception with its error rules, registers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/sci.h"

#include <algorithm>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

std::uint8_t reversed(std::uint8_t byte) {
  unsigned r = 0;
  for (unsigned k = 0; k < 8; ++k) r |= (byte >> k & 1u) << (7 - k);
  return static_cast<std::uint8_t>(r);
}

}  // namespace

// Async: 32 * 4^n * (N + 1) states, sync: 4 * 4^n * (N + 1).
States Sci::bit_states() const {
  const States unit = synchronous() ? 4 : 32;
  return (unit << (2 * (smr_ & SMR::CKS))) * (brr_ + 1);
}

int Sci::frame_bits() const {
  if (synchronous()) return 8;
  return 1 + data_bits() + (parity() || multiprocessor() ? 1 : 0) + stop_bits();
}

std::uint8_t Sci::on_wire(std::uint8_t byte) const {
  if (scmr_ & SCMR::SDIR) byte = reversed(byte);
  if (scmr_ & SCMR::SINV) byte = static_cast<std::uint8_t>(~byte);
  return data_bits() == 7 ? byte & kSevenBits : byte;
}

void Sci::update(Machine& m, unsigned n, States at) {
  const unsigned base = n == 0 ? vec::kEri0 : vec::kEri1;
  unsigned levels = 0;
  if (scr_ & SCR::RIE)
    levels |= (flags_.has(kErrors) ? 1u : 0u) | (flags_.has(SSR::RDRF) ? 2u : 0u);
  if ((scr_ & SCR::TIE) && flags_.has(SSR::TDRE)) levels |= 4;
  if ((scr_ & SCR::TEIE) && tend_) levels |= 8;
  m.irq.set_all(base, 4, levels, at);
}

void Sci::run_events(Machine& m, unsigned n, States to) {
  for (;;) {
    const States at = next_event();
    if (at > to) return;
    if (end_ == at) send_event(m, n, at);
    if (sample_ == at) sample(m, at);
    if (arrives_ == at) {
      arrives_ = kNever;
      take(m, n, arrived_);
      // Reception alone in clocked mode continues until an overrun.
      if (burst_ != kNever) {
        burst_ = flags_.has(kErrors) ? kNever : at;
        if (burst_ != kNever) begin_clocked(at);
      }
    }
    if (!incoming_.empty() && incoming_.front().at == at) {
      const ReceivedByte byte = incoming_.front();
      incoming_.pop_front();
      take(m, n, byte);
    }
    update(m, n, at);
  }
}

void Sci::reset(Machine& m, unsigned n, States at) {
  std::deque<ReceivedByte> wire = std::move(incoming_);
  const bool level = rxd_, driven = rxd_driven_;
  *this = Sci{};
  incoming_ = std::move(wire);
  rxd_ = level;
  rxd_driven_ = driven;
  clock_base_ = at;
  update(m, n, at);
}

std::uint8_t Sci::peek(unsigned offset) const {
  switch (offset) {
    case kSmr:
      return smr_;
    case kBrr:
      return brr_;
    case kScr:
      return scr_;
    case kTdr:
      return tdr_;
    case kSsr:
      return flags_.value() | (tend_ ? SSR::TEND : 0) | (mpb_ ? SSR::MPB : 0) |
             (mpbt_ ? SSR::MPBT : 0);
    case kRdr:
      return rdr_;
    default:
      return scmr_;
  }
}

std::uint8_t Sci::read(Machine& m, unsigned n, unsigned offset, States at) {
  advance(m, n, at);
  return read_now(offset);
}

void Sci::enable(Machine& m, unsigned n, std::uint8_t value, States at) {
  const std::uint8_t before = scr_;
  scr_ = value;
  if ((before ^ value) & SCR::CKE) clock_base_ = at;
  if (!(value & SCR::TE)) {
    flags_.raise(SSR::TDRE);
    tend_ = true;
    stop_sending();
  } else if (!(before & SCR::TE) && m.options.sci_preamble && !synchronous() && !outside_clock()) {
    sending_ = Sending::preamble;
    end_ = at + frame_bits() * bit_states();
  }
  if (!(value & SCR::RE)) {
    stop_receiving();
    arrives_ = kNever;
  }
  start_reception_clock(at);
  if ((before ^ value) & (SCR::TE | SCR::RE | SCR::CKE))
    m.notify(OutputChange::Unit::port, n == 0 ? 5 : 2, at);
}

// Clocked reception without transmission generates its own clocks, in groups of eight.
void Sci::start_reception_clock(States at) {
  const bool wanted = synchronous() && !outside_clock() &&
                      (scr_ & (SCR::TE | SCR::RE)) == SCR::RE && !flags_.has(kErrors);
  if (!wanted) {
    burst_ = kNever;
  } else if (burst_ == kNever) {
    burst_ = at;
    begin_clocked(at);
  }
}

void Sci::taken_by_dtc(Machine& m, unsigned n, States at) {
  flags_.drop(SSR::RDRF);
  update(m, n, at);
}

void Sci::filled_by_dtc(Machine& m, unsigned n, States at) {
  if (!(scr_ & SCR::TE)) return;
  flags_.drop(SSR::TDRE);
  tend_ = false;
  if (sending_ == Sending::nothing) begin(m, n, at);
  update(m, n, at);
}

void Sci::write(Machine& m, unsigned n, unsigned offset, std::uint8_t value, States at) {
  advance(m, n, at);
  const bool busy = (scr_ & (SCR::TE | SCR::RE)) != 0;
  const std::uint32_t address = (n == 0 ? io::SMR0 : io::SMR1) + offset;
  switch (offset) {
    case kSmr:
    case kBrr:
    case kScmr:
      if (busy) m.misuse(address, "serial format or rate changed while TE or RE is set");
      if (offset == kSmr) smr_ = value;
      if (offset == kBrr) brr_ = value;
      if (offset <= kBrr) clock_base_ = at;
      if (offset == kScmr) scmr_ = value | SCMR::ONE;
      break;
    case kScr:
      enable(m, n, value, at);
      break;
    case kTdr:
      tdr_ = value;
      return;  // no request depends on it
    case kSsr: {
      mpbt_ = (value & SSR::MPBT) != 0;
      const std::uint8_t cleared = flags_.write(value | SSR::TEND | SSR::MPB | SSR::MPBT);
      if (synchronous() || burst_ != kNever) start_reception_clock(at);
      // An overrun had blocked the next byte of clocked mode.
      if ((cleared & SSR::ORER) && !flags_.has(SSR::TDRE | SSR::ORER) &&
          sending_ == Sending::nothing)
        begin(m, n, at);
      if (!(cleared & SSR::TDRE)) break;
      if (!(scr_ & SCR::TE)) {
        flags_.raise(SSR::TDRE);  // TE = 0 holds TDRE at 1
        break;
      }
      tend_ = false;
      if (sending_ == Sending::nothing) begin(m, n, at);
      break;
    }
    default:
      m.misuse(address, "write to RDR, which is read-only");
      break;
  }
  update(m, n, at);
}

}  // namespace kaz::h8s
