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

std::optional<Time> LatenessMeter::lost() const {
  return other_end_ ? other_end_() : std::nullopt;
}

void LatenessMeter::begin() {
  lost_before_ = lost();
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

std::string LatenessMeter::excuse() const {
  const double length_s = seconds(clock_.now() - began_);
  const bool often = total_ >= kExcusing && seconds(total_) > kExcusingShare * length_s;
  if (longest_ >= kExcusing || often)
    return "this program was kept waiting for up to " + in_ms(longest_) + ", " + in_ms(total_) +
           " in all";
  const auto lost_now = lost();
  if (lost_now && lost_before_ && *lost_now > *lost_before_)
    return "the program at the other end fell behind by " + in_ms(*lost_now - *lost_before_);
  return "";
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
