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
constexpr std::uint8_t kMode = ADCSR::SCAN | ADCSR::CKS | ADCSR::CH;

std::uint16_t code_of(double share) {
  if (!(share > 0)) return 0;
  return static_cast<std::uint16_t>(std::min(share * 1024, 1023.0));
}

}  // namespace

// AN0..AN7 are 0..7; with KBADE channel 6 is CIN0..CIN7 (8..15).
int Adc::source() const {
  if ((kbcomp_ & KBCOMP::KBADE) && channel_ == 6) return 8 + (kbcomp_ & KBCOMP::KBCH);
  return static_cast<int>(channel_);
}

void Adc::update(Machine& m, States at) {
  m.irq.set(vec::kAdi, adf_.has(ADCSR::ADF) && (adcsr_ & ADCSR::ADIE), at);
}

void Adc::start(Machine& m, States at) {
  adcsr_ |= ADCSR::ADST;
  channel_ = first_channel();
  const int delay = fast() ? m.options.adc_start_delay_fast : m.options.adc_start_delay_slow;
  sampled_ = false;
  next_ = at + delay + (fast() ? kSampleFast : kSampleSlow);
  end_ = at + delay + (fast() ? kConvertFast : kConvertSlow);
}

void Adc::trigger(Machine& m, unsigned source, States at) {
  if (field<ADCR::TRGS>(adcr_) != source || (adcsr_ & ADCSR::ADST) || m.stopped(kStopAdc)) return;
  start(m, at);
  m.rescheduled(Source::adc);
}

inline void Adc::finish(Machine& m) {
  data_[channel_ % 4] = static_cast<std::uint16_t>(held_ << 6);
  const bool last = !scan() || channel_ == (adcsr_ & ADCSR::CH);
  const States at = end_;
  if (last) {
    adf_.raise(ADCSR::ADF);
    if (adcsr_ & ADCSR::ADIE) update(m, at);
  }
  if (!scan()) {
    adcsr_ &= ~ADCSR::ADST;
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
  if (!scan() || end_ > to || ((adcsr_ & ADCSR::ADIE) && !adf_.has(ADCSR::ADF))) return;
  const States period = fast() ? kScanFast : kScanSlow;
  const States channels = (adcsr_ & ADCSR::CH) - first_channel() + 1;
  const States ends = (to - end_) / period + 1;
  const States skipped = (ends - channels) / channels * channels;
  if (skipped <= 0) return;
  adf_.raise(ADCSR::ADF);
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
    case io::ADCSR:
      return static_cast<std::uint8_t>(adcsr_ | adf_.value());
    case io::ADCR:
      return adcr_;
    case io::KBCOMP:
      return kbcomp_;
    default: {
      const std::uint16_t word = data_[address / 2 % 4];
      return static_cast<std::uint8_t>(address & 1 ? word : word >> 8);
    }
  }
}

std::uint8_t Adc::read(Machine& m, std::uint32_t address, States at) {
  advance(m, at);
  return read_now(address);
}

std::uint8_t Adc::read_now(std::uint32_t address) {
  if (address == io::ADCSR) adf_.read();
  if (address >= io::ADCSR || address < io::ADDRA) return peek(address);
  if (address & 1) return temp_;
  const std::uint16_t word = data_[address / 2 % 4];
  temp_ = static_cast<std::uint8_t>(word);
  return static_cast<std::uint8_t>(word >> 8);
}

void Adc::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  advance(m, at);
  const bool running = (adcsr_ & ADCSR::ADST) != 0;
  switch (address) {
    case io::ADCSR: {
      if (running && ((value ^ adcsr_) & kMode))
        m.misuse(address, "A/D mode or channel changed while a conversion runs");
      adf_.write(static_cast<std::uint8_t>(value | ~ADCSR::ADF));
      adcsr_ = (value & (ADCSR::ADIE | kMode)) | (adcsr_ & ADCSR::ADST);
      if ((value & ADCSR::ADST) && !running) start(m, at);
      if (!(value & ADCSR::ADST)) {
        adcsr_ &= ~ADCSR::ADST;
        next_ = end_ = kNever;
      }
      break;
    }
    case io::ADCR:
      adcr_ = value | ADCR::ONE;
      break;
    case io::KBCOMP:
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
