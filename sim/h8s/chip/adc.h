// 10-bit A/D converter with single mode and scan mode. The emulator samples each input in exactly the clock
// period (state) that the hardware manual specifies.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/chip/sticky.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class Adc {
 public:
  // Register accesses. `address` contains only the low 16 bits of the address: ADDRA..ADCR or KBCOMP.
  std::uint8_t read(Machine& m, std::uint32_t address, States at);
  // Like read(). Precondition: no event is due.
  std::uint8_t read_now(std::uint32_t address);
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  std::uint8_t peek(std::uint32_t address) const;
  void reset(Machine& m, States at);
  // Clears the flag ADF. Must be called after a DTC activation that has read a result. If the activation
  // passes the interrupt to the CPU, taken_by_dtc() must not be called.
  void taken_by_dtc(Machine& m, States at) {
    adf_.drop(ADCSR::ADF);
    update(m, at);
  }

  States next_event() const { return next_; }
  // Returns the time of the next interrupt request, which is the end of a conversion. Returns kNever if the
  // converter cannot raise a request. A conversion that raises no request does not affect other modules of
  // the chip.
  States next_request() const {
    if (!(adcsr_ & ADCSR::ADIE) || adf_.has(ADCSR::ADF)) return kNever;
    if (end_ == kNever || !scan()) return end_;
    return end_ +
           static_cast<States>((adcsr_ & ADCSR::CH) - channel_) * (fast() ? kScanFast : kScanSlow);
  }
  void advance(Machine& m, States to) {
    if (next_ <= to) convert(m, to);
  }
  // Returns true in scan mode. In this mode, the emulator can postpone the computation of a conversion. The
  // conversion is computed when the program reads a result, or before an output of the chip changes.
  bool may_wait() const { return scan(); }
  // Processes all events up to the time `to`, or until `ended` is set. Before each event, sets `at` to the
  // time of the event.
  void run_events(Machine& m, States to, States& at, const bool& ended);
  // Starts a conversion if the field TRGS of the register ADCR equals `source`. `source` is 2 for the 8-bit
  // timer and 3 for the ADTRG pin.
  void trigger(Machine& m, unsigned source, States at);

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(adcsr_, adcr_, kbcomp_, temp_, adf_, data_, channel_, sampled_, held_, next_, end_);
    a.require(channel_ < 8, "converter's channel");
  }

 private:
  // Duration (states) of each conversion in scan mode, except the first conversion.
  static constexpr States kScanSlow = 256, kScanFast = 128;

  bool scan() const { return (adcsr_ & ADCSR::SCAN) != 0; }
  bool fast() const { return (adcsr_ & ADCSR::CKS) != 0; }
  unsigned first_channel() const { return scan() ? adcsr_ & ADCSR::CH2 : adcsr_ & ADCSR::CH; }
  int source() const;
  void start(Machine& m, States at);
  void convert(Machine& m, States to);
  void skip(States to);
  void step(Machine& m);
  void sample(Machine& m);
  void finish(Machine& m);
  void update(Machine& m, States at);

  std::uint8_t adcsr_ = 0;  // ADCSR without ADF
  std::uint8_t adcr_ = ADCR::ONE, kbcomp_ = 0, temp_ = 0;
  StickyFlags adf_;
  std::array<std::uint16_t, 4> data_{};  // ADDRA..ADDRD: result << 6
  unsigned channel_ = 0;
  bool sampled_ = false;
  std::uint16_t held_ = 0;
  States next_ = kNever;  // time of the next event: sampling or end of a conversion
  States end_ = kNever;   // end of the conversion
};

}  // namespace kaz::h8s
