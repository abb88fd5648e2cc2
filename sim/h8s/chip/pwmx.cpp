// 14-bit PWM: registers behind TEMP, counter, and the waveform in closed form.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/pwmx.h"

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

constexpr unsigned kPeriod = 0x4000;

unsigned reversed(unsigned value, int bits) {
  unsigned r = 0;
  for (int k = 0; k < bits; ++k) r |= (value >> k & 1u) << (bits - 1 - k);
  return r;
}

// Counts of the pulse in one base cycle: the upper bits of the data, plus one in as many cycles as
// the lower bits specify, in bit-reversed order as in the 8-bit PWM.
unsigned width_in(unsigned data, bool long_cycle, unsigned cycle) {
  const int low_bits = long_cycle ? 6 : 8;
  const unsigned width = data >> low_bits, extra = data & ((1u << low_bits) - 1);
  if (width == 0) return 0;
  const unsigned rank = (1u << low_bits) - 1 - reversed(cycle, low_bits);
  return width + (rank < extra ? 1 : 0);
}

}  // namespace

bool pwmx_pulse(unsigned data, bool long_cycle, unsigned count) {
  const unsigned length = long_cycle ? 256 : 64;
  return count % length < width_in(data, long_cycle, count / length);
}

unsigned Pwmx::counter(States at) const {
  if (!counting()) return base_count_;
  return (base_count_ + static_cast<unsigned>((at - base_) / period())) & (kPeriod - 1);
}

// DACNT shows counter bits 7..0 in its upper byte and 8..13 in bits 7..2 of the lower.
std::uint16_t Pwmx::packed_counter(States at) const {
  const unsigned c = counter(at);
  return static_cast<std::uint16_t>((c & 0xff) << 8 | reversed(c >> 8, 6) << 2 | DACNT::ONE |
                                    (dadr_[1] & DADR::REGS));
}

bool Pwmx::level(unsigned channel, States at, bool data_is_low) const {
  const unsigned data = dadr_[channel] >> 2;
  const bool pulse = pwmx_pulse(data, (dadr_[channel] & DADR::CFS) != 0, counter(at));
  const bool inverted = (dacr_ & DACR::OS) != 0;
  return pulse != (data_is_low != inverted);
}

States Pwmx::next_change(unsigned channel, States at, bool data_is_low) const {
  if (!counting() || !enabled(channel)) return kNever;
  const bool before = level(channel, at, data_is_low);
  const bool long_cycle = (dadr_[channel] & DADR::CFS) != 0;
  const unsigned length = long_cycle ? 256 : 64;
  const States done = (at - base_) / period();  // counts since base_
  States ahead = done;
  // Levels change at the start of a base cycle and at the end of its pulse only.
  for (unsigned k = 0; k <= 2 * (kPeriod / length); ++k) {
    const unsigned count = (base_count_ + static_cast<unsigned>(ahead)) & (kPeriod - 1);
    const unsigned in_cycle = count % length;
    const unsigned end = width_in(dadr_[channel] >> 2, long_cycle, count / length);
    ahead += in_cycle < end ? end - in_cycle : length - in_cycle;
    const States edge = base_ + ahead * period();
    if (level(channel, edge, data_is_low) != before) return edge;
  }
  return kNever;
}

std::uint8_t Pwmx::peek(std::uint32_t address, States at) const {
  const bool low = (address & 1) != 0;
  if (address < io::DADRB) {
    if (second_bank()) return low ? 0xff : dacr_;
    return static_cast<std::uint8_t>(low ? dadr_[0] | DADR::ONE : dadr_[0] >> 8);
  }
  const std::uint16_t word = second_bank() ? packed_counter(at) : dadr_[1];
  return static_cast<std::uint8_t>(low ? word : word >> 8);
}

std::uint8_t Pwmx::read(std::uint32_t address, States at) {
  if (address == io::DADRA && second_bank()) return dacr_;
  if (address & 1) return temp_;
  temp_ = peek(address + 1, at);
  return peek(address, at);
}

void Pwmx::set_control(std::uint8_t value, States at) {
  const unsigned count = counter(at);
  dacr_ = value | DACR::ONE;
  base_ = at;
  base_count_ = counting() ? count : 0;
}

void Pwmx::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  const auto word = static_cast<std::uint16_t>(temp_ << 8 | value);
  switch (address) {
    case io::DADRA:
      if (second_bank()) {
        if (value & DACR::TEST) m.misuse(address, "DACR.TEST set: the 14-bit PWM is in test mode");
        set_control(value, at);
        break;
      }
      [[fallthrough]];
    case io::DADRB:
      temp_ = value;
      return;
    case io::DADRA + 1:
      if (second_bank())
        m.misuse(address,
                 "write to the address after DACR: while REGS is 1, this address has no register");
      else
        dadr_[0] = word | DADR::ONE;
      break;
    default:
      if (second_bank()) {
        // Bit 0 is REGS in both banks.
        base_count_ = (word >> 8 & 0xffu) | reversed(field<DACNT::UC>(word), 6) << 8;
        base_ = at;
        dadr_[1] = static_cast<std::uint16_t>((dadr_[1] & ~DADR::REGS) | (value & DADR::REGS));
      } else {
        dadr_[1] = word;
      }
      break;
  }
  m.notify(OutputChange::Unit::port, 1, at);
}

}  // namespace kaz::h8s
