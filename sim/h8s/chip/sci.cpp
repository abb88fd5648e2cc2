// Serial channel: double-buffered transmission, reception with its error rules, registers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/sci.h"

#include <algorithm>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
using namespace sci_bits;

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
  return (unit << (2 * (smr_ & 3))) * (brr_ + 1);
}

int Sci::frame_bits() const {
  if (synchronous()) return 8;
  return 1 + data_bits() + (parity() || multiprocessor() ? 1 : 0) + stop_bits();
}

std::uint8_t Sci::on_wire(std::uint8_t byte) const {
  if (scmr_ & 8) byte = reversed(byte);
  if (scmr_ & 4) byte = static_cast<std::uint8_t>(~byte);
  return data_bits() == 7 ? byte & 0x7f : byte;
}

void Sci::update(Machine& m, unsigned n, States at) {
  const unsigned base = n == 0 ? vec::eri0 : vec::eri1;
  unsigned levels = 0;
  if (scr_ & kRie) levels |= (flags_.has(kErrors) ? 1u : 0u) | (flags_.has(kRdrf) ? 2u : 0u);
  if ((scr_ & kTie) && flags_.has(kTdre)) levels |= 4;
  if ((scr_ & kTeie) && tend_) levels |= 8;
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
    case 0:
      return smr_;
    case 1:
      return brr_;
    case 2:
      return scr_;
    case 3:
      return tdr_;
    case 4:
      return static_cast<std::uint8_t>(flags_.value() | (tend_ ? 4 : 0) | (mpb_ ? 2 : 0) |
                                       (mpbt_ ? 1 : 0));
    case 5:
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
  if ((before ^ value) & kCke) clock_base_ = at;
  if (!(value & kTe)) {
    flags_.raise(kTdre);
    tend_ = true;
    stop_sending();
  } else if (!(before & kTe) && m.options.sci_preamble && !synchronous() && !outside_clock()) {
    sending_ = Sending::preamble;
    end_ = at + frame_bits() * bit_states();
  }
  if (!(value & kRe)) {
    stop_receiving();
    arrives_ = kNever;
  }
  start_reception_clock(at);
  if ((before ^ value) & (kTe | kRe | kCke)) m.notify(OutputChange::Unit::port, n == 0 ? 5 : 2, at);
}

// Clocked reception without transmission generates its own clocks, in groups of eight.
void Sci::start_reception_clock(States at) {
  const bool wanted =
      synchronous() && !outside_clock() && (scr_ & (kTe | kRe)) == kRe && !flags_.has(kErrors);
  if (!wanted) {
    burst_ = kNever;
  } else if (burst_ == kNever) {
    burst_ = at;
    begin_clocked(at);
  }
}

void Sci::taken_by_dtc(Machine& m, unsigned n, States at) {
  flags_.drop(kRdrf);
  update(m, n, at);
}

void Sci::filled_by_dtc(Machine& m, unsigned n, States at) {
  if (!(scr_ & kTe)) return;
  flags_.drop(kTdre);
  tend_ = false;
  if (sending_ == Sending::nothing) begin(m, n, at);
  update(m, n, at);
}

void Sci::write(Machine& m, unsigned n, unsigned offset, std::uint8_t value, States at) {
  advance(m, n, at);
  const bool busy = (scr_ & (kTe | kRe)) != 0;
  const std::uint32_t address = (n == 0 ? 0xffd8u : 0xff88u) + offset;
  switch (offset) {
    case 0:
    case 1:
    case 6:
      if (busy) m.misuse(address, "serial format or rate changed while TE or RE is set");
      if (offset == 0) smr_ = value;
      if (offset == 1) brr_ = value;
      if (offset <= 1) clock_base_ = at;
      if (offset == 6) scmr_ = static_cast<std::uint8_t>((value & 0x0d) | 0xf2);
      break;
    case 2:
      enable(m, n, value, at);
      break;
    case 3:
      tdr_ = value;
      return;  // no request depends on it
    case 4: {
      mpbt_ = (value & 1) != 0;
      const std::uint8_t cleared = flags_.write(static_cast<std::uint8_t>(value | 7));
      if (synchronous() || burst_ != kNever) start_reception_clock(at);
      // An overrun had blocked the next byte of clocked mode.
      if ((cleared & kOrer) && !flags_.has(kTdre | kOrer) && sending_ == Sending::nothing)
        begin(m, n, at);
      if (!(cleared & kTdre)) break;
      if (!(scr_ & kTe)) {
        flags_.raise(kTdre);  // TE = 0 holds TDRE at 1
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
