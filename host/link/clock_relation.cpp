// Intersection of the intervals that exchanges give for the board's clock.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/clock_relation.h"

#include <algorithm>
#include <cmath>

#include "shared/board/board.h"

namespace kaz::host {

namespace {

constexpr Time kTick = std::chrono::nanoseconds(1'000'000'000 / KZ_TICK_HZ);

}  // namespace

Time ClockRelation::ticks_since_origin(std::uint32_t tick) const {
  return kTick * static_cast<std::int32_t>(tick - origin_tick_);
}

void ClockRelation::add(const Exchange& exchange) {
  const Time low = exchange.sent + byte_time_ * exchange.bytes_out;
  // A link that reports an impossible delay (byte_time too long for it) must not give an empty
  // interval.
  const Time high = std::max(low, exchange.received - kTick - byte_time_ * exchange.bytes_in);

  if (known_) {
    // Move the interval from the start of the old tick to that of the new one.
    const Time step = ticks_since_origin(exchange.tick);
    const auto aged = from_seconds(kDriftBound * std::abs(seconds(exchange.received - latest_)));
    low_ = std::max(low, low_ + step - aged);
    high_ = std::min(high, high_ + step + aged);
    if (low_ > high_) {
      ++restarts_;
      known_ = false;
    }
  }
  if (!known_) {
    low_ = low;
    high_ = high;
    known_ = true;
  }
  origin_tick_ = exchange.tick;
  latest_ = exchange.received;
}

Time ClockRelation::host_time(std::uint32_t tick) const {
  return low_ + (high_ - low_) / 2 + ticks_since_origin(tick);
}

}  // namespace kaz::host
