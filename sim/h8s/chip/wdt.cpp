// Watchdog timers: counting, overflow, keyed writes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/wdt.h"

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {

States Wdt::divisor(const Machine& m, unsigned n) const {
  constexpr States table[] = {2, 64, 128, 512, 2048, 8192, 32768, 131072};
  // PSS: WDT1 counts the subclock, a second crystal that the board may lack.
  if (n == 1 && subclocked())
    return m.options.subclock_states * (States{2} << (tcsr_ & WTCSR::CKS));
  return table[tcsr_ & WTCSR::CKS];
}

// The subclock continues while the system clock is stopped.
States Wdt::base(const Machine& m, unsigned n) const {
  return n == 1 && subclocked() ? m.sub_epoch : m.epoch;
}

std::int64_t Wdt::ticks(const Machine& m, unsigned n, States at) const {
  const States d = divisor(m, n);
  return d ? (at - base(m, n)) / d : 0;
}

void Wdt::update(Machine& m, unsigned n, States at) {
  const bool interval = (tcsr_ & WTCSR::WTIT) == 0;
  m.irq.set(n == 0 ? vec::kWovi0 : vec::kWovi1, interval && ovf_.has(WTCSR::OVF), at);
}

void Wdt::advance(Machine& m, unsigned n, States to) {
  const States d = divisor(m, n);
  if (!running() || d == 0) return;
  const std::int64_t target = (to - base(m, n)) / d;
  const std::int64_t gone = target - tick_;
  if (gone <= 0) return;
  const std::int64_t turns = (count_ + gone) / 256;
  const std::int64_t first = tick_ + 256 - count_;
  count_ = static_cast<std::uint8_t>((count_ + gone) & 0xff);
  tick_ = target;
  if (turns == 0) return;
  const States at = base(m, n) + first * d;
  ovf_.raise(WTCSR::OVF);
  update(m, n, at);
  if (!watchdog()) return;
  if (tcsr_ & WTCSR::RSTNMI)
    m.watchdog_reset = true;
  else
    m.irq.set(vec::kNmi, true, at);
}

// An interval timer whose flag is already set has no further event.
States Wdt::next_event(const Machine& m, unsigned n) const {
  const States d = divisor(m, n);
  if (!running() || d == 0 || (!watchdog() && ovf_.has(WTCSR::OVF))) return kNever;
  return base(m, n) + (tick_ + 256 - count_) * d;
}

std::uint8_t Wdt::peek(const Machine& m, unsigned n, bool counter, States at) const {
  if (!counter) return static_cast<std::uint8_t>(tcsr_ | ovf_.value());
  const std::int64_t gone = running() && divisor(m, n) ? ticks(m, n, at) - tick_ : 0;
  return static_cast<std::uint8_t>(count_ + gone);
}

std::uint8_t Wdt::read(Machine& m, unsigned n, bool counter, States at) {
  advance(m, n, at);
  if (!counter) ovf_.read();
  return peek(m, n, counter, at);
}

void Wdt::write_word(Machine& m, unsigned n, std::uint16_t value, States at) {
  advance(m, n, at);
  const auto byte = static_cast<std::uint8_t>(value);
  if (value >> 8 == 0x5a) {
    if (running()) count_ = byte;
  } else if (value >> 8 == 0xa5) {
    tcsr_ = byte & ~WTCSR::OVF;
    ovf_.write(static_cast<std::uint8_t>(byte | ~WTCSR::OVF));
    if (!running()) count_ = 0;
  } else {
    m.misuse(n == 0 ? io::WTCSR0 : io::WTCSR1,
             "watchdog written without its key (5A or A5 in the upper byte)");
  }
  tick_ = ticks(m, n, at);
  update(m, n, at);
}

}  // namespace kaz::h8s
