// Counting shared by the four 8-bit timers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/timer8.h"

#include <algorithm>

namespace kaz::h8s {
namespace {

std::int64_t distance(unsigned count, unsigned value) {
  return static_cast<std::int64_t>((value - count) & 0xff) + 1;
}

// Output selection: 0 keep, 1 low, 2 high, 3 toggle.
bool apply(bool level, unsigned action) {
  return action == 3 ? !level : action == 2 ? true : action == 1 ? false : level;
}

}  // namespace

bool timer_output(bool level, std::uint8_t selection, bool a, bool b) {
  const unsigned on_a = a ? field<TMR_TCSR::OS10>(selection) : 0;
  const unsigned on_b = b ? field<TMR_TCSR::OS32>(selection) : 0;
  return apply(level, std::max(on_a, on_b));
}

std::int64_t Timer8::to_next() const {
  return std::min({distance(count, tcora), distance(count, tcorb), distance(count, 0xff)});
}

void Timer8::matched(bool a, bool b) {
  if (a) flags.raise(TMR_TCSR::CMFA);
  if (b) flags.raise(TMR_TCSR::CMFB);
  level = timer_output(level, tcsr_low & TMR_TCSR::OS, a, b);
}

Timer8::Crossed Timer8::step(std::int64_t counts, Clear clearing) {
  const bool a = counts == distance(count, tcora), b = counts == distance(count, tcorb);
  const bool clears = (a && clearing == Clear::on_a) || (b && clearing == Clear::on_b);
  const bool wraps = counts == distance(count, 0xff) && !clears;
  count = clears ? std::uint8_t{0} : static_cast<std::uint8_t>(count + counts);
  matched(a, b);
  if (wraps) flags.raise(TMR_TCSR::OVF);
  return {a, b, wraps};
}

std::int64_t Timer8::turn() const {
  return clear() == Clear::on_a ? tcora + 1 : clear() == Clear::on_b ? tcorb + 1 : 0x100;
}

void Timer8::skip_turns(States target) {
  const std::int64_t one = turn();
  const std::int64_t whole = toggles() ? 2 * one : one;
  if (count < one && target - tick > one + whole) tick += (target - tick - one) / whole * whole;
}

std::int64_t Timer8::to_next_change() const {
  if (!drives()) return kNever;
  Timer8 ahead = *this;
  std::int64_t counts = 0;
  // Two periods include every crossing at both levels.
  for (int crossing = 0; crossing < 8; ++crossing) {
    const std::int64_t next = ahead.to_next();
    counts += next;
    ahead.step(next);
    if (ahead.level != level) return counts;
  }
  return kNever;
}

}  // namespace kaz::h8s
