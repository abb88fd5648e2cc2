// Serial channel: reception from levels at RxD, and of whole bytes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/line_rate.h"
#include "sim/h8s/chip/machine.h"
#include "sim/h8s/chip/sci.h"

namespace kaz::h8s {
namespace {

// A bit has 16 basic clocks. The sample is 7 clocks after the first one that sees the start bit, so
// 7/16 to 8/16 of a bit after the edge.
constexpr int kClocksPerBit = 16, kClocksToSample = 7;

}  // namespace

// Rules of reception: errors block, an overrun loses the new byte, a byte with an error is copied
// without RDRF (hardware manual, SCI: receive operation).
void Sci::take(Machine& m, unsigned n, const ReceivedByte& arrived) {
  if (m.boot.measuring() && n == static_cast<unsigned>(m.options.boot_channel))
    return m.boot.heard(m, arrived);
  ReceivedByte byte = arrived;
  if (byte.bit_states > 0 && byte.bit_states != bit_states() && frame_bits() == 10 &&
      !synchronous()) {
    const HeardByte heard = heard_at(byte.value, byte.bit_states, bit_states());
    if (!heard.heard) return;
    byte.value = heard.value;
    byte.framing_error |= heard.framing_error;
  }
  if (!(scr_ & SCR::RE) || m.stopped(n == 0 ? kStopSci0 : kStopSci1) || flags_.has(kErrors)) return;
  if (multiprocessor() && (scr_ & SCR::MPIE)) {
    if (!byte.multiprocessor) return;
    scr_ &= ~SCR::MPIE;
  }
  const bool bad_parity = parity() && byte.parity_error;
  const bool bad_frame = !synchronous() && byte.framing_error;
  if (bad_frame) flags_.raise(SSR::FER);
  if (bad_parity) flags_.raise(SSR::PER);
  if (flags_.has(SSR::RDRF)) {
    flags_.raise(SSR::ORER);
    return;
  }
  rdr_ = on_wire(byte.value);
  mpb_ = multiprocessor() && byte.multiprocessor;
  if (!bad_frame && !bad_parity) flags_.raise(SSR::RDRF);
}

void Sci::rxd_edge(Machine& m, unsigned n, bool level, bool driven, States at) {
  if (m.boot.measuring() && driven && level != rxd_ &&
      n == static_cast<unsigned>(m.options.boot_channel))
    m.boot.edge(m, level, at);
  if (m.stopped(n == 0 ? kStopSci0 : kStopSci1)) {
    rxd_ = level;
    rxd_driven_ = driven;
    return;
  }
  advance(m, n, at);
  const bool fell = rxd_ && !level;
  rxd_ = level;
  rxd_driven_ = driven;
  if (!driven && receiving_) stop_receiving();
  if (!driven || !fell || receiving_ || !(scr_ & SCR::RE) || synchronous()) return;
  if (!flags_.has(kErrors)) start_bit(at);
}

void Sci::start_bit(States edge) {
  receiving_ = true;
  received_ = 0;
  rsr_ = 0;
  edge_ = edge;
  if (outside_clock()) {
    sample_ticks_ = 1 + kClocksToSample;
    sample_ = kNever;
    return;
  }
  const States clock = bit_states() / kClocksPerBit;
  const States seen = clock_base_ + ((edge - clock_base_) / clock + 1) * clock;
  sample_ = seen + kClocksToSample * clock;
}

void Sci::sample(Machine& m, States at) {
  if (synchronous()) return sample_clocked(m, this == &m.sci[0] ? 0 : 1, at);
  if (received_ == 0 && rxd_) {  // a false start bit
    stop_receiving();
    return;
  }
  rsr_ = static_cast<std::uint16_t>(rsr_ | (rxd_ ? 1u : 0u) << received_);
  ++received_;
  if (sample_ != kNever) sample_ = at + bit_states();
  // Only the first stop bit is checked.
  if (received_ >= frame_bits() - stop_bits() + 1)
    judge(m, outside_clock() ? at : edge_ + frame_bits() * bit_states());
}

void Sci::begin_clocked(States at) {
  receiving_ = true;
  received_ = 0;
  rsr_ = 0;
  sample_ = rxd_driven_ ? at + bit_states() / 2 : kNever;
}

void Sci::sample_clocked(Machine& m, unsigned, States at) {
  if (!receiving_) begin_clocked(at);
  rsr_ = static_cast<std::uint16_t>(rsr_ | (rxd_ ? 1u : 0u) << received_);
  sample_ = outside_clock() ? kNever : at + bit_states();
  if (++received_ >= 8) judge(m, outside_clock() ? at : at + bit_states() / 2);
}

// All bits are received; the byte becomes available at `end`.
void Sci::judge(Machine& m, States end) {
  ReceivedByte byte;
  byte.at = m.options.sci_ready_mid_stop && sample_ != kNever ? sample_ - bit_states() : end;
  const unsigned bits = synchronous() ? rsr_ : rsr_ >> 1;
  byte.value = static_cast<std::uint8_t>(bits & (data_bits() == 7 ? kSevenBits : 0xffu));
  if (!synchronous()) {
    const bool next = (bits >> data_bits() & 1) != 0;
    byte.multiprocessor = multiprocessor() && next;
    byte.parity_error = parity() && next != parity_of(byte.value);
    byte.framing_error = (rsr_ >> (received_ - 1) & 1) == 0;
  }
  stop_receiving();
  arrived_ = byte;
  arrives_ = byte.at;
}

void Sci::stop_receiving() {
  receiving_ = false;
  sample_ = kNever;
  received_ = 0;
}

}  // namespace kaz::h8s
