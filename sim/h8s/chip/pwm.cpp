// 8-bit PWM: registers and waveform.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/pwm.h"

#include <bit>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {

bool pwm_pulse(std::uint8_t data, unsigned count, bool right_aligned) {
  // Basic pulses that get an additional count, in the order in which the lower nibble adds them.
  constexpr std::array<std::uint8_t, 15> order{15, 7, 11, 3, 13, 5, 9, 1, 14, 6, 10, 2, 12, 4, 8};
  const unsigned width = data >> 4, extra = data % 16u, pulse = count >> 4;
  const unsigned slot = right_aligned ? count % 16 : 15 - count % 16;
  if (slot >= 16 - width) return true;
  if (slot != 15 - width) return false;
  for (unsigned k = 0; k < extra; ++k) {
    if (order[k] == pulse) return true;
  }
  return false;
}

unsigned Pwm::counter(States at) const {
  const States d = divisor();
  if (d == 0) return base_count_ & 0xff;
  const int shift = std::countr_zero(static_cast<std::uint64_t>(d));
  const States since = ((at - epoch_) >> shift) - ((base_ - epoch_) >> shift);
  return (base_count_ + static_cast<unsigned>(since & 0xff)) & 0xff;
}

bool Pwm::level(unsigned channel, States at, bool right_aligned) const {
  return pwm_pulse(data_[channel], counter(at), right_aligned) != ((os_ >> channel & 1) != 0);
}

States Pwm::next_change(unsigned channel, States at, bool right_aligned) const {
  const States d = divisor();
  if (d == 0) return kNever;
  const unsigned from = counter(at);
  const bool now = pwm_pulse(data_[channel], from, right_aligned);
  for (unsigned k = 1; k < 256; ++k) {
    if (pwm_pulse(data_[channel], (from + k) & 0xff, right_aligned) != now)
      return epoch_ + (tick(at) + k) * d;
  }
  return kNever;
}

int Pwm::high_counts(unsigned channel, States at) const {
  const bool inverted = (os_ >> channel & 1) != 0;
  if (divisor() == 0) return level(channel, at, true) ? 256 : 0;
  return inverted ? 256 - data_[channel] : data_[channel];
}

std::uint8_t Pwm::peek(std::uint32_t address) const {
  switch (address) {
    case io::PWOERB:
      return static_cast<std::uint8_t>(oe_ >> 8);
    case io::PWOERA:
      return static_cast<std::uint8_t>(oe_);
    case io::PWDPRB:
      return static_cast<std::uint8_t>(os_ >> 8);
    case io::PWDPRA:
      return static_cast<std::uint8_t>(os_);
    case io::PWSL:
      return select_;
    case io::PWDR:
      return data_[select_ & PWSL::RS];
    default:
      return pcsr_;
  }
}

void Pwm::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  const auto high = [value](std::uint16_t v) {
    return static_cast<std::uint16_t>(value << 8 | (v & 0xff));
  };
  const auto low = [value](std::uint16_t v) {
    return static_cast<std::uint16_t>((v & 0xff00) | value);
  };
  int channel = -1;
  bool changed = true;
  switch (address) {
    case io::PWOERB:
      oe_ = high(oe_);
      break;
    case io::PWOERA:
      oe_ = low(oe_);
      break;
    case io::PWDPRB:
      os_ = high(os_);
      break;
    case io::PWDPRA:
      os_ = low(os_);
      break;
    case io::PWSL:
    case io::PCSR: {
      const States before = divisor();
      base_count_ = counter(at);
      base_ = at;
      if (address == io::PWSL)
        select_ = (value & ~PWSL::ZERO) | PWSL::ONE;
      else
        pcsr_ = value & PCSR::PWCK;
      changed = divisor() != before;
      break;
    }
    default:
      channel = select_ & PWSL::RS;
      changed = data_[select_ & PWSL::RS] != value;
      data_[select_ & PWSL::RS] = value;
      break;
  }
  if (changed) m.notify(OutputChange::Unit::pwm, channel, at);
}

}  // namespace kaz::h8s
