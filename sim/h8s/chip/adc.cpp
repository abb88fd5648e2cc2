// A/D converter: conversion sequence and registers (hardware manual, A/D converter: tD, tSPL, tCONV).
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/adc.h"

#include <algorithm>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

// States without the start delay: sampling, and conversion from the start delay's end.
constexpr States kSampleSlow = 63, kSampleFast = 31;
constexpr States kConvertSlow = 249, kConvertFast = 125;

std::uint16_t code_of(double share) {
  if (!(share > 0)) return 0;
  return static_cast<std::uint16_t>(std::min(share * 1024, 1023.0));
}

}  // namespace

// AN0..AN7 are 0..7; with KBADE channel 6 is CIN0..CIN7 (8..15).
int Adc::source() const {
  if ((kbcomp_ & 8) && channel_ == 6) return 8 + (kbcomp_ & 7);
  return static_cast<int>(channel_);
}

void Adc::update(Machine& m, States at) {
  m.irq.set(vec::adi, adf_.has(0x80) && (adcsr_ & 0x40), at);
}

void Adc::start(Machine& m, States at) {
  adcsr_ |= 0x20;
  channel_ = first_channel();
  const int delay = fast() ? m.options.adc_start_delay_fast : m.options.adc_start_delay_slow;
  sampled_ = false;
  next_ = at + delay + (fast() ? kSampleFast : kSampleSlow);
  end_ = at + delay + (fast() ? kConvertFast : kConvertSlow);
}

void Adc::trigger(Machine& m, unsigned source, States at) {
  if (adcr_ >> 6 != static_cast<int>(source) || (adcsr_ & 0x20) || m.stopped(Stop_adc)) return;
  start(m, at);
  m.rescheduled(Source::adc);
}

inline void Adc::finish(Machine& m) {
  data_[channel_ & 3] = static_cast<std::uint16_t>(held_ << 6);
  const bool last = !scan() || channel_ == (adcsr_ & 7u);
  const States at = end_;
  if (last) {
    adf_.raise(0x80);
    if (adcsr_ & 0x40) update(m, at);
  }
  if (!scan()) {
    adcsr_ &= static_cast<std::uint8_t>(~0x20);
    next_ = end_ = kNever;
    return;
  }
  channel_ = last ? first_channel() : channel_ + 1;
  sampled_ = false;
  next_ = at + (fast() ? kSampleFast : kSampleSlow);
  end_ = at + (fast() ? kScanFast : kScanSlow);
}

void Adc::step(Machine& m) {
  if (sampled_) return finish(m);
  sample(m);
}

inline void Adc::sample(Machine& m) {
  held_ = m.listeners.analog ? code_of(m.listeners.analog(source(), next_)) : std::uint16_t{0};
  sampled_ = true;
  next_ = end_;
}

// Of a scan's conversions that end by `to` only the last of each channel are read by anything.
void Adc::skip(States to) {
  if (!scan() || end_ > to || ((adcsr_ & 0x40) && !adf_.has(0x80))) return;
  const States period = fast() ? kScanFast : kScanSlow;
  const States channels = (adcsr_ & 7u) - first_channel() + 1;
  const States ends = (to - end_) / period + 1;
  const States skipped = (ends - channels) / channels * channels;
  if (skipped <= 0) return;
  adf_.raise(0x80);
  sampled_ = false;
  end_ += skipped * period;
  next_ = end_ - period + (fast() ? kSampleFast : kSampleSlow);
}

void Adc::convert(Machine& m, States to) {
  if (m.conversions_wait()) skip(to);
  while (next_ <= to) step(m);
}

void Adc::run_events(Machine& m, States to, States& at, const bool& ended) {
  do {
    at = next_;
    if (!sampled_) {
      sample(m);
      if (next_ > to || ended) return;
      at = next_;
    }
    finish(m);
  } while (next_ <= to && !ended);
}

void Adc::reset(Machine& m, States at) {
  *this = Adc{};
  update(m, at);
}

std::uint8_t Adc::peek(std::uint32_t address) const {
  switch (address) {
    case 0xffe8:
      return static_cast<std::uint8_t>(adcsr_ | adf_.value());
    case 0xffe9:
      return adcr_;
    case 0xfee4:
      return kbcomp_;
    default: {
      const std::uint16_t word = data_[address >> 1 & 3];
      return static_cast<std::uint8_t>(address & 1 ? word : word >> 8);
    }
  }
}

std::uint8_t Adc::read(Machine& m, std::uint32_t address, States at) {
  advance(m, at);
  return read_now(address);
}

std::uint8_t Adc::read_now(std::uint32_t address) {
  if (address == 0xffe8) adf_.read();
  if (address >= 0xffe8 || address < 0xffe0) return peek(address);
  if (address & 1) return temp_;
  const std::uint16_t word = data_[address >> 1 & 3];
  temp_ = static_cast<std::uint8_t>(word);
  return static_cast<std::uint8_t>(word >> 8);
}

void Adc::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  advance(m, at);
  const bool running = (adcsr_ & 0x20) != 0;
  switch (address) {
    case 0xffe8: {
      if (running && ((value ^ adcsr_) & 0x1f))
        m.misuse(address, "A/D mode or channel changed while a conversion runs");
      adf_.write(static_cast<std::uint8_t>(value | 0x7f));
      adcsr_ = static_cast<std::uint8_t>((value & 0x5f) | (adcsr_ & 0x20));
      if ((value & 0x20) && !running) start(m, at);
      if (!(value & 0x20)) {
        adcsr_ &= static_cast<std::uint8_t>(~0x20);
        next_ = end_ = kNever;
      }
      break;
    }
    case 0xffe9:
      adcr_ = static_cast<std::uint8_t>(value | 0x3f);
      break;
    case 0xfee4:
      if (running) m.misuse(address, "KBCOMP changed while a conversion runs");
      kbcomp_ = value;
      break;
    default:
      m.misuse(address, "write to an A/D result register, which is read-only");
      break;
  }
  update(m, at);
}

}  // namespace kaz::h8s
