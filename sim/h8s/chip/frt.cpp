// Free-running timer: counting in closed form, matches, captures and registers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/frt.h"

#include <algorithm>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {

States Frt::divisor() const {
  constexpr States table[] = {2, 8, 32, 0};
  return table[tcr_ & FRT_TCR::CKS];
}

// Ticks until the counter leaves `value`, which is when a match takes effect.
std::int64_t Frt::to_count(std::uint32_t value) const {
  return static_cast<std::int64_t>((value - count_) & 0xffff) + 1;
}

std::int64_t Frt::to_next() const {
  return std::min({to_count(ocr_[0]), to_count(ocr_[1]), to_count(0xffff)});
}

void Frt::update(Machine& m, States at) {
  const unsigned active = flags_.value() & tier_ & (kCaptures | kCounts);
  unsigned levels = 0;
  for (unsigned n = 0; n < 7; ++n) levels |= (active >> (7 - n) & 1u) << n;
  m.irq.set_all(vec::kIcia, 7, levels, at);
}

void Frt::taken_by_dtc(Machine& m, unsigned vector, States at) {
  flags_.drop(static_cast<std::uint8_t>(FRT_TCSR::ICFA >> (vector - vec::kIcia)));
  update(m, at);
}

void Frt::match(Machine& m, unsigned n, States at) {
  flags_.raise(n == 0 ? FRT_TCSR::OCFA : FRT_TCSR::OCFB);
  const bool to = (tocr_ & (n == 0 ? TOCR::OLVLA : TOCR::OLVLB)) != 0;
  if (level_[n] != to) {
    level_[n] = to;
    if (drives(n)) m.notify(OutputChange::Unit::port, 6, at);
  }
  if (n == 0 && (tocr_ & TOCR::OCRAMS)) {
    ocr_[0] = static_cast<std::uint16_t>(ocr_[0] + (use_af_ ? ocraf_ : ocrar_));
    use_af_ = !use_af_;
  }
}

// `counts` does not go beyond the next match.
void Frt::step(Machine& m, std::int64_t counts, States at) {
  const bool a = counts == to_count(ocr_[0]), b = counts == to_count(ocr_[1]);
  const bool wraps = counts == to_count(0xffff);
  if (masked_ && counts >= ((mask_end_ - count_) & 0xffff)) masked_ = false;
  count_ = static_cast<std::uint16_t>(count_ + counts);
  if (wraps && !(a && clear_on_a_)) flags_.raise(FRT_TCSR::OVF);
  if (b) match(m, 1, at);
  if (a) {
    match(m, 0, at);
    if (clear_on_a_) count_ = 0;
  }
}

void Frt::advance(Machine& m, States to) {
  const States d = divisor();
  if (d == 0) return;
  const States target = (to - m.epoch) / d;
  const bool stopped = m.stopped(kStopFrt);
  if (stopped) {
    tick_ = target;
    return;
  }
  bool changed = false;
  while (tick_ < target) {
    const std::int64_t counts = std::min<std::int64_t>(to_next(), target - tick_);
    tick_ += counts;
    const std::uint8_t before = flags_.value();
    step(m, counts, m.epoch + tick_ * d);
    if (flags_.value() != before) {
      update(m, m.epoch + tick_ * d);
      changed = true;
    }
    // All possible flags are set: whole periods of the counter change nothing.
    const std::int64_t turn = clear_on_a_ ? ocr_[0] + 1 : 0x10000;
    if (before == flags_.value() && !(tocr_ & (TOCR::OCRAMS | TOCR::OEA | TOCR::OEB)) && !masked_ &&
        count_ < turn && target - tick_ > 2 * turn)
      tick_ += ((target - tick_) / turn - 1) * turn;
  }
  if (changed) update(m, to);
}

States Frt::next_event(States epoch) const {
  const States d = divisor();
  if (d == 0) return kNever;
  // Flags that are already set cannot change again; pins can.
  const std::uint8_t wanted = static_cast<std::uint8_t>(tier_ & ~flags_.value());
  std::int64_t counts = kNever;
  if ((wanted & FRT_TCSR::OCFA) || drives(0)) counts = std::min(counts, to_count(ocr_[0]));
  if ((wanted & FRT_TCSR::OCFB) || drives(1)) counts = std::min(counts, to_count(ocr_[1]));
  if (wanted & FRT_TCSR::OVF) counts = std::min(counts, to_count(0xffff));
  if (counts == kNever) return kNever;
  // A clear at A may come first and prevent the others: check again then.
  if (clear_on_a_) counts = std::min(counts, to_count(ocr_[0]));
  return epoch + (tick_ + counts) * d;
}

States Frt::next_change(States epoch, unsigned output) const {
  const States d = divisor();
  if (d == 0 || level_[output] == ((tocr_ & (output == 0 ? TOCR::OLVLA : TOCR::OLVLB)) != 0))
    return kNever;
  std::int64_t counts = to_count(ocr_[output]);
  if (clear_on_a_) counts = std::min(counts, to_count(ocr_[0]));
  return epoch + (tick_ + counts) * d;
}

void Frt::clock_edge(Machine& m, States at) {
  if (divisor() != 0 || m.stopped(kStopFrt)) return;
  step(m, 1, at);
  update(m, at);
}

// IEDGA..IEDGD choose the edge; with ICRC as ICRA's buffer, IEDGC adds a second edge to FTIA (and ICRD
// to FTIB).
bool Frt::captures_edge(unsigned n, bool rising) const {
  const auto chosen = [&](unsigned k) { return ((tcr_ >> (7 - k) & 1) != 0) == rising; };
  const bool buffered = n < 2 && (tcr_ >> (3 - n) & 1) != 0;
  return chosen(n) || (buffered && chosen(n + 2));
}

void Frt::capture_edge(Machine& m, unsigned n, bool rising, States at) {
  if (m.stopped(kStopFrt) || !captures_edge(n, rising)) return;
  advance(m, at);
  if (n == 3 && masked_) return;
  if (n == 0 && (tcr_ & FRT_TCR::BUFEA)) icr_[2] = icr_[0];
  if (n == 1 && (tcr_ & FRT_TCR::BUFEB)) icr_[3] = icr_[1];
  const bool buffer = (n == 2 && (tcr_ & FRT_TCR::BUFEA)) || (n == 3 && (tcr_ & FRT_TCR::BUFEB));
  if (!buffer) icr_[n] = count_;
  if (n == 3 && (tocr_ & TOCR::ICRDMS) && ocrdm_ != 0) {
    masked_ = true;
    mask_end_ = static_cast<std::uint16_t>(icr_[3] + 2 * ocrdm_);
  }
  flags_.raise(static_cast<std::uint8_t>(FRT_TCSR::ICFA >> n));
  update(m, at);
}

std::uint8_t Frt::peek(std::uint32_t address) const {
  const auto half = [address](std::uint16_t v) {
    return static_cast<std::uint8_t>(address & 1 ? v : v >> 8);
  };
  const bool second = (tocr_ & TOCR::ICRS) != 0;
  switch (address) {
    case io::TIER:
      return tier_;
    case io::TCSR:
      return flags_.value() | (clear_on_a_ ? FRT_TCSR::CCLRA : 0);
    case io::FRC:
    case io::FRC + 1:
      return half(count_);
    case io::OCRA:
    case io::OCRA + 1:
      return half(ocr_[tocr_ & TOCR::OCRS ? 1 : 0]);
    case io::TCR:
      return tcr_;
    case io::TOCR:
      return tocr_;
    case io::ICRA16:
    case io::ICRA16 + 1:
      return half(second ? ocrar_ : icr_[0]);
    case io::ICRB16:
    case io::ICRB16 + 1:
      return half(second ? ocraf_ : icr_[1]);
    case io::ICRC16:
    case io::ICRC16 + 1:
      return half(second ? ocrdm_ : icr_[2]);
    default:
      return half(icr_[3]);
  }
}

std::uint8_t Frt::read(Machine& m, std::uint32_t address, States at) {
  advance(m, at);
  if (address == io::TCSR) flags_.read();
  const std::uint8_t value = peek(address);
  // Reading an upper byte latches the lower; OCR is read directly.
  const bool latched = address == io::FRC || (address >= io::ICRA16 && !(tocr_ & TOCR::ICRS)) ||
                       address >= io::ICRD16;
  if (latched && !(address & 1)) temp_ = peek(address + 1);
  const bool through_temp =
      address == io::FRC + 1 || ((address & 1) && address >= io::ICRA16 + 1 &&
                                 (!(tocr_ & TOCR::ICRS) || address == io::ICRD16 + 1));
  return through_temp ? temp_ : value;
}

void Frt::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  // In the state of the write itself, a write to FRC wins over the count; one to OCR suppresses
  // its match.
  advance(m, at - 1);
  const auto word = static_cast<std::uint16_t>(temp_ << 8 | value);
  std::uint16_t& ocr = ocr_[tocr_ & TOCR::OCRS ? 1 : 0];
  if (address == io::OCRA + 1) ocr = static_cast<std::uint16_t>(count_ ^ 0x8000);
  if (address < io::FRC || address > io::OCRA) advance(m, at);
  switch (address) {
    case io::TIER:
      tier_ = value | TIER::ONE;
      break;
    case io::TCSR:
      flags_.write(value | FRT_TCSR::CCLRA);
      clear_on_a_ = (value & FRT_TCSR::CCLRA) != 0;
      break;
    case io::FRC + 1:
      count_ = word;
      if (divisor() != 0) tick_ = (at - m.epoch) / divisor();
      break;
    case io::OCRA + 1:
      ocr = word;
      break;
    case io::TCR:
      tcr_ = value;
      if (divisor() != 0) tick_ = (at - m.epoch) / divisor();
      break;
    case io::TOCR:
      tocr_ = value;
      m.notify(OutputChange::Unit::port, 6, at);
      break;
    case io::ICRA16 + 1:
    case io::ICRB16 + 1:
    case io::ICRC16 + 1:
      if (!(tocr_ & TOCR::ICRS)) {
        m.misuse(address, "write to an input capture register of the FRT, which is read-only");
      } else {
        // OCRDM's upper byte is always 0.
        (address == io::ICRA16 + 1   ? ocrar_
         : address == io::ICRB16 + 1 ? ocraf_
                                     : ocrdm_) = address == io::ICRC16 + 1 ? value : word;
      }
      break;
    case io::ICRD16 + 1:
      m.misuse(address, "write to ICRD of the FRT, which is read-only");
      break;
    default:
      temp_ = value;
      break;  // upper bytes
  }
  update(m, at);
}

}  // namespace kaz::h8s
