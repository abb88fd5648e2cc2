// Serial channel: transmission, and the levels of TxD and SCK (hardware manual, SCI: operation).
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>

#include "sim/h8s/chip/machine.h"
#include "sim/h8s/chip/sci.h"

namespace kaz::h8s {
namespace {

// External clocks per bit: 16 asynchronous, otherwise 1.
constexpr int kClocksPerBit = 16;
// First of base + k * period that is not before `at`.
States grid_from(States base, States period, States at) {
  return at <= base ? base : base + (at - base + period - 1) / period * period;
}
States grid_after(States base, States period, States at) {
  return at < base ? base : base + ((at - base) / period + 1) * period;
}

}  // namespace

bool Sci::parity_of(std::uint8_t wire) const {
  return ((std::popcount(wire) & 1) != 0) != ((smr_ & SMR::OE) != 0);
}

SerialFrame Sci::frame_of(std::uint8_t wire) const {
  if (synchronous()) return {wire, 8};
  unsigned bits = static_cast<unsigned>(wire) << 1;
  int count = 1 + data_bits();
  if (multiprocessor()) bits |= (mpbt_ ? 1u : 0u) << count++;
  if (parity()) bits |= (parity_of(wire) ? 1u : 0u) << count++;
  for (int k = 0; k < stop_bits(); ++k) bits |= 1u << count++;
  return {static_cast<std::uint16_t>(bits), count};
}

// TDR holds a byte and the shift register is free.
void Sci::begin(Machine& m, unsigned n, States at) {
  // An overrun stops the clock of clocked mode for both directions.
  if (synchronous() && (scr_ & SCR::RE) && flags_.has(SSR::ORER)) return;
  const bool aligned = !synchronous() && (m.options.sci_aligned_start || drives_sck());
  const States first = aligned ? grid_from(clock_base_, bit_states(), at) : at;
  if (outside_clock() || first == at) return load(m, n, at);
  sending_ = Sending::waiting;
  end_ = first;
}

// TDR into the shift register; the start bit begins at `at`. The caller updates the requests.
void Sci::load(Machine& m, unsigned n, States at) {
  before_ = !synchronous() || txd(at);
  tsr_ = on_wire(tdr_);
  frame_ = frame_of(tsr_);
  flags_.raise(SSR::TDRE);
  tend_ = false;
  sending_ = Sending::frame;
  start_ = at;
  ticks_ = 0;
  bit_ = outside_clock() ? 0 : bit_states();
  end_ = outside_clock() ? kNever : at + frame_.count * bit_;
  if (synchronous() && !outside_clock() && (scr_ & SCR::RE)) begin_clocked(at);
  m.notify(OutputChange::Unit::serial, static_cast<int>(n), at);
}

void Sci::send_event(Machine& m, unsigned n, States at) {
  if (sending_ == Sending::waiting) return load(m, n, at);
  end_of_frame(m, n, at);
}

void Sci::end_of_frame(Machine& m, unsigned n, States at) {
  const bool sent = sending_ == Sending::frame;
  const SerialFrame last = frame_;
  before_ = !synchronous() || !sent || last.at(last.count - 1);
  sending_ = Sending::nothing;
  end_ = kNever;
  if (sent && m.listeners.transmitted)
    m.listeners.transmitted(static_cast<int>(n), {tsr_, start_, at});
  if (!flags_.has(SSR::TDRE))
    begin(m, n, at);
  else
    tend_ = true;
}

void Sci::stop_sending() {
  sending_ = Sending::nothing;
  before_ = true;
  end_ = kNever;
}

// An external clock: 16 rising edges per bit; in clocked mode falling edges shift bits out and the
// eighth rising one ends the frame.
void Sci::send_tick(Machine& m, unsigned n, States at) {
  if (sending_ != Sending::frame) return;
  if (++ticks_ == 1) start_ = at;
  if (synchronous() || ticks_ <= std::int64_t{kClocksPerBit} * frame_.count) return;
  end_of_frame(m, n, at);
  if (sending_ == Sending::frame) ticks_ = 1;
}

void Sci::sck_edge(Machine& m, unsigned n, bool rising, States at) {
  if (!outside_clock() || m.stopped(n == 0 ? kStopSci0 : kStopSci1)) return;
  advance(m, n, at);
  if (synchronous()) {
    if (!rising) {
      send_tick(m, n, at);
    } else {
      if (takes_rxd() && rxd_driven_) sample_clocked(m, n, at);
      if (sending_ == Sending::frame && ticks_ == frame_.count) end_of_frame(m, n, at);
    }
  } else if (rising) {
    send_tick(m, n, at);
    if (receiving_ && --sample_ticks_ == 0) {
      sample_ticks_ = kClocksPerBit;
      sample(m, at);
    }
  }
  update(m, n, at);
}

bool Sci::txd(States at) const {
  if (sending_ != Sending::frame || at < start_) return before_;
  States k = 0;
  if (bit_ != 0) {
    k = (at - start_) / bit_;
  } else {
    if (ticks_ == 0) return before_;
    k = synchronous() ? ticks_ - 1 : (ticks_ - 1) / kClocksPerBit;
  }
  if (synchronous()) k = std::min<States>(k, frame_.count - 1);
  return frame_.at(k);
}

States Sci::txd_change(States after) const {
  if (sending_ == Sending::waiting) return end_ > after ? end_ : kNever;
  if (sending_ == Sending::frame && bit_ != 0) {
    const States first = after < start_ ? 0 : (after - start_) / bit_ + 1;
    for (States k = first; k < frame_.count; ++k)
      if (frame_.at(k) != (k == 0 ? before_ : frame_.at(k - 1))) return start_ + k * bit_;
  }
  // The next start bit; in clocked mode TDR may still be changed.
  const bool follows = sending_ != Sending::nothing && !flags_.has(SSR::TDRE) && !synchronous();
  return follows && end_ != kNever && end_ > after ? end_ : kNever;
}

bool Sci::clock_runs() const {
  return burst_ != kNever || (sending_ == Sending::frame && bit_ != 0);
}

bool Sci::sck(States at) const {
  if (!synchronous()) {
    const States bit = bit_states();
    return at >= clock_base_ && (at - clock_base_) % bit >= bit / 2;
  }
  if (!clock_runs()) return true;
  const States bit = bit_states(), from = burst_ != kNever ? burst_ : start_;
  if (at < from || at >= from + 8 * bit) return true;
  return (at - from) % bit >= bit / 2;
}

States Sci::sck_change(States after) const {
  if (!drives_sck()) return kNever;
  const States half = bit_states() / 2;
  if (!synchronous()) return grid_after(clock_base_, half, after);
  if (!clock_runs()) return kNever;
  const States from = burst_ != kNever ? burst_ : start_;
  const States next = grid_after(from, half, after), end = from + 16 * half;
  if (next < end) return next;
  // Clocks continue while reception alone needs them or TDR holds another byte.
  const bool more = burst_ != kNever || !flags_.has(SSR::TDRE);
  return more && end > after ? end : kNever;
}

}  // namespace kaz::h8s
