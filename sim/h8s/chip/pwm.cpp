// 8-bit PWM: registers and waveform.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/pwm.h"

#include <bit>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {

bool pwm_pulse(std::uint8_t data, unsigned count, bool right_aligned) {
  // Basic pulses that get an additional count, in the order in which the lower nibble adds them.
  constexpr std::array<std::uint8_t, 15> order{15, 7, 11, 3, 13, 5, 9, 1, 14, 6, 10, 2, 12, 4, 8};
  const unsigned width = data >> 4, extra = data & 15u, pulse = count >> 4;
  const unsigned slot = right_aligned ? count & 15u : 15 - (count & 15u);
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
    case 0xffd2:
      return static_cast<std::uint8_t>(oe_ >> 8);
    case 0xffd3:
      return static_cast<std::uint8_t>(oe_);
    case 0xffd4:
      return static_cast<std::uint8_t>(os_ >> 8);
    case 0xffd5:
      return static_cast<std::uint8_t>(os_);
    case 0xffd6:
      return select_;
    case 0xffd7:
      return data_[select_ & 15];
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
    case 0xffd2:
      oe_ = high(oe_);
      break;
    case 0xffd3:
      oe_ = low(oe_);
      break;
    case 0xffd4:
      os_ = high(os_);
      break;
    case 0xffd5:
      os_ = low(os_);
      break;
    case 0xffd6:
    case 0xff82: {
      const States before = divisor();
      base_count_ = counter(at);
      base_ = at;
      if (address == 0xffd6)
        select_ = static_cast<std::uint8_t>((value & 0xcf) | 0x20);
      else
        pcsr_ = value & 6;
      changed = divisor() != before;
      break;
    }
    default:
      channel = select_ & 15;
      changed = data_[select_ & 15] != value;
      data_[select_ & 15] = value;
      break;
  }
  if (changed) m.notify(OutputChange::Unit::pwm, channel, at);
}

}  // namespace kaz::h8s
