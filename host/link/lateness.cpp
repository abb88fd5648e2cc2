// Compares the ends of waits with the times at which they were due.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/lateness.h"

#include <algorithm>
#include <cstdio>

#include "shared/base/time.hpp"

namespace kaz::host {
namespace {

// "34 ms"
std::string in_ms(Time t) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f ms", 1e3 * seconds(t));
  return text;
}

}  // namespace

LatenessMeter::LatenessMeter(Link& link, Clock& clock, TimeLost other_end)
    : link_(link), clock_(clock), other_end_(std::move(other_end)) {
  begin();
}

void LatenessMeter::begin() {
  lost_before_.reset();
  if (other_end_) {
    if (const auto lost = other_end_()) lost_before_ = *lost;
  }
  other_end_gone_ = false;
  longest_ = total_ = Time::zero();
  began_ = left_ = clock_.now();
}

void LatenessMeter::add(Time late) {
  longest_ = std::max(longest_, late);
  if (late > kNoticed) total_ += late;
}

// The callers compute for microseconds between two calls: a longer pause was not theirs.
Time LatenessMeter::enter() {
  const Time now = clock_.now();
  add(now - left_);
  return now;
}

void LatenessMeter::leave(Time due) {
  left_ = clock_.now();
  add(left_ - due);
}

std::string LatenessMeter::excuse(Time at_least) const {
  const double length_s = seconds(clock_.now() - began_);
  other_end_gone_ = false;
  if (other_end_) {
    const auto lost = other_end_();
    other_end_gone_ = !lost;
    if (!lost)
      return "the program at the other end of " + name() +
             " does not reply, because that program is stopped or has ended";
    if (!lost_before_) return "the program at the other end was stopped";
    if (*lost > *lost_before_ && *lost - *lost_before_ >= at_least)
      return "the program at the other end fell behind by " + in_ms(*lost - *lost_before_);
  }
  const Time excusing = std::max(kExcusing, at_least);
  // What bears a lateness bears it often, too.
  const bool often =
      at_least == Time::zero() && total_ >= excusing && seconds(total_) > kExcusingShare * length_s;
  if (longest_ < excusing && !often) return "";
  return "this program was kept waiting for up to " + in_ms(longest_) + " at a time, and for " +
         in_ms(total_) + " in total";
}

Result<void> LatenessMeter::write(std::span<const std::uint8_t> bytes) {
  const Time began = enter();
  auto written = link_.write(bytes);
  leave(began);
  return written;
}

Result<std::size_t> LatenessMeter::read(std::span<std::uint8_t> bytes, Time deadline) {
  Time now = enter();
  while (true) {
    // A deadline in the past: only what is there already.
    const Time due = std::max(now, std::min(deadline, now + kSlice));
    auto count = link_.read(bytes, due);
    leave(due);
    now = left_;
    if (!count || *count > 0 || now >= deadline) return count;
  }
}

Result<void> LatenessMeter::sleep_until(Time t) {
  const Time due = std::max(enter(), t);
  auto slept = clock_.sleep_until(t);
  leave(due);
  return slept;
}

}  // namespace kaz::host
