// Serial channel: double-buffered transmission, reception with its error rules, registers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/sci.h"

#include <algorithm>
#include <bit>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

constexpr std::uint8_t kTdre = 0x80, kRdrf = 0x40, kOrer = 0x20, kFer = 0x10, kPer = 0x08;
constexpr std::uint8_t kErrors = kOrer | kFer | kPer;
constexpr std::uint8_t kTie = 0x80, kRie = 0x40, kTe = 0x20, kRe = 0x10, kMpie = 0x08, kTeie = 0x04;

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
  const bool parity = (smr_ & 0x20) != 0 && !(smr_ & 4), multi = (smr_ & 4) != 0;
  return 1 + data_bits() + (parity ? 1 : 0) + (multi ? 1 : 0) + (smr_ & 8 ? 2 : 1);
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

// TDR into the shift register; the start bit begins at `at`.
void Sci::load(Machine& m, unsigned n, States at) {
  tsr_ = on_wire(tdr_);
  flags_.raise(kTdre);
  tend_ = false;
  shifting_ = true;
  preamble_ = false;
  start_ = at;
  end_ = at + frame_bits() * bit_states();
  update(m, n, at);
}

void Sci::end_of_frame(Machine& m, unsigned n, States at) {
  shifting_ = false;
  end_ = kNever;
  if (!preamble_ && m.listeners.transmitted)
    m.listeners.transmitted(static_cast<int>(n), {tsr_, start_, at});
  preamble_ = false;
  if (!flags_.has(kTdre))
    load(m, n, at);
  else
    tend_ = true;
}

// Rules of reception: errors block, an overrun loses the new byte, a bad frame is copied without
// RDRF.
void Sci::take(Machine& m, unsigned n, const ReceivedByte& byte) {
  const unsigned stop = n == 0 ? Stop_sci0 : Stop_sci1;
  if (!(scr_ & kRe) || m.stopped(stop) || flags_.has(kErrors)) return;
  // Multiprocessor format: without an id bit the byte is not for this chip.
  if ((smr_ & 4) && (scr_ & kMpie)) return;
  const bool parity = (smr_ & 0x20) && byte.parity_error;
  if (byte.framing_error) flags_.raise(kFer);
  if (parity) flags_.raise(kPer);
  if (flags_.has(kRdrf)) {
    flags_.raise(kOrer);
    return;
  }
  rdr_ = on_wire(byte.value);
  if (!byte.framing_error && !parity) flags_.raise(kRdrf);
}

States Sci::next_event() const {
  return incoming_.empty() ? end_ : std::min(end_, incoming_.front().at);
}

void Sci::advance(Machine& m, unsigned n, States to) {
  for (;;) {
    const States at = next_event();
    if (at > to) return;
    if (end_ == at) end_of_frame(m, n, at);
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
  *this = Sci{};
  incoming_ = std::move(wire);
  update(m, n, at);
}

bool Sci::txd(States at) const {
  if (!shifting_ || preamble_ || at < start_) return true;
  const States bit = (at - start_) / bit_states();
  const int data = data_bits();
  if (synchronous()) return (tsr_ >> std::min<States>(bit, 7) & 1) != 0;
  if (bit == 0) return false;
  if (bit <= data) return (tsr_ >> (bit - 1) & 1) != 0;
  if (bit == data + 1 && (smr_ & 4)) return mpbt_;
  if (bit == data + 1 && (smr_ & 0x20))
    return ((std::popcount(tsr_) & 1) != 0) != ((smr_ & 0x10) != 0);
  return true;
}

States Sci::next_change(States at) const {
  if (!shifting_ || at >= end_) return kNever;
  if (preamble_) return end_;
  if (at < start_) return start_;
  return std::min(end_, start_ + ((at - start_) / bit_states() + 1) * bit_states());
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
      return static_cast<std::uint8_t>(flags_.value() | (tend_ ? 4 : 0) | (mpbt_ ? 1 : 0));
    case 5:
      return rdr_;
    default:
      return scmr_;
  }
}

std::uint8_t Sci::read(Machine& m, unsigned n, unsigned offset, States at) {
  advance(m, n, at);
  if (offset == 4) flags_.read();
  return peek(offset);
}

void Sci::enable(Machine& m, unsigned n, std::uint8_t value, States at) {
  const std::uint8_t before = scr_;
  scr_ = value;
  if (!(value & kTe)) {
    flags_.raise(kTdre);
    tend_ = true;
    shifting_ = preamble_ = false;
    end_ = kNever;
  } else if (!(before & kTe) && m.options.sci_preamble && !synchronous()) {
    shifting_ = preamble_ = true;
    end_ = at + frame_bits() * bit_states();
  }
  if ((before ^ value) & kTe) m.notify(OutputChange::Unit::port, n == 0 ? 5 : 2, at);
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
      if (offset == 6) scmr_ = static_cast<std::uint8_t>((value & 0x0d) | 0xf2);
      break;
    case 2:
      enable(m, n, value, at);
      break;
    case 3:
      tdr_ = value;
      break;
    case 4: {
      mpbt_ = (value & 1) != 0;
      const std::uint8_t cleared = flags_.write(static_cast<std::uint8_t>(value | 7));
      if (!(cleared & kTdre)) break;
      if (!(scr_ & kTe)) {
        flags_.raise(kTdre);  // TE = 0 holds TDRE at 1
        break;
      }
      tend_ = false;
      if (!shifting_) load(m, n, at);
      break;
    }
    default:
      m.misuse(address, "write to RDR, which is read-only");
      break;
  }
  update(m, n, at);
}

}  // namespace kaz::h8s
