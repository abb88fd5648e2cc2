// The 10-bit A/D converter: single and scan mode, sampling at the exact state.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/chip/sticky.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class Adc {
 public:
  // FFE0..FFE9 and KBCOMP at FEE4.
  std::uint8_t read(Machine& m, std::uint32_t address, States at);
  // The same when no event is due.
  std::uint8_t read_now(std::uint32_t address);
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  std::uint8_t peek(std::uint32_t address) const;
  void reset(Machine& m, States at);
  // The DTC has read a result and will read more.
  void taken_by_dtc(Machine& m, States at) {
    adf_.drop(0x80);
    update(m, at);
  }

  States next_event() const { return next_; }
  // When the conversion ends that raises an interrupt request; kNever while none can. The others affect
  // nothing else on the chip.
  States next_request() const {
    if (!(adcsr_ & 0x40) || adf_.has(0x80)) return kNever;
    if (end_ == kNever || !scan()) return end_;
    return end_ + static_cast<States>((adcsr_ & 7u) - channel_) * (fast() ? kScanFast : kScanSlow);
  }
  void advance(Machine& m, States to) {
    if (next_ <= to) convert(m, to);
  }
  // A scan's conversions may be done together, when something reads them or the chip's outputs change.
  bool may_wait() const { return scan(); }
  // The next event, and those that follow up to `to`, each with its time in `at`, until `ended`.
  void run_events(Machine& m, States to, States& at, const bool& ended);
  // External trigger, by the value of ADCR.TRGS: 2 is the 8-bit timer, 3 the ADTRG pin.
  void trigger(Machine& m, unsigned source, States at);

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(adcsr_, adcr_, kbcomp_, temp_, adf_, data_, channel_, sampled_, held_, next_, end_);
    a.require(channel_ < 8, "converter's channel");
  }

 private:
  // States of each further conversion in scan mode.
  static constexpr States kScanSlow = 256, kScanFast = 128;

  bool scan() const { return (adcsr_ & 0x10) != 0; }
  bool fast() const { return (adcsr_ & 0x08) != 0; }
  unsigned first_channel() const { return scan() ? adcsr_ & 4u : adcsr_ & 7u; }
  int source() const;
  void start(Machine& m, States at);
  void convert(Machine& m, States to);
  void skip(States to);
  void step(Machine& m);
  void sample(Machine& m);
  void finish(Machine& m);
  void update(Machine& m, States at);

  std::uint8_t adcsr_ = 0;  // without ADF
  std::uint8_t adcr_ = 0x3f, kbcomp_ = 0, temp_ = 0;
  StickyFlags adf_;
  std::array<std::uint16_t, 4> data_{};  // result << 6
  unsigned channel_ = 0;
  bool sampled_ = false;
  std::uint16_t held_ = 0;
  States next_ = kNever;  // the sampling, or the end of the conversion
  States end_ = kNever;
};

}  // namespace kaz::h8s
