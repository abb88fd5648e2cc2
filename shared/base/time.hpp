// Host time in nanoseconds, with arithmetic that does not overflow.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_TIME_HPP
#define KAZ_SHARED_BASE_TIME_HPP

#include <chrono>
#include <cstdint>

namespace kaz {

// Nanoseconds on the host's clock: simulated time in lockstep, CLOCK_MONOTONIC otherwise.
using Time = std::chrono::nanoseconds;

inline double seconds(Time t) {
  return std::chrono::duration<double>(t).count();
}
inline Time from_seconds(double s) {
  return Time(static_cast<std::int64_t>(s * 1e9 + (s < 0 ? -0.5 : 0.5)));
}

// between() returns a - b, and later() returns a + b, both clamped to the range of Time. The times can have
// any value, because they may come from the clocks of other machines.
inline Time between(Time a, Time b) {
  std::int64_t ns = 0;
  if (__builtin_sub_overflow(a.count(), b.count(), &ns)) return a < b ? Time::min() : Time::max();
  return Time(ns);
}
inline Time later(Time a, Time b) {
  std::int64_t ns = 0;
  if (__builtin_add_overflow(a.count(), b.count(), &ns))
    return b < Time(0) ? Time::min() : Time::max();
  return Time(ns);
}

}  // namespace kaz

#endif
