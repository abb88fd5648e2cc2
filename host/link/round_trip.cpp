// RFC 6298 in a few lines.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/round_trip.h"

#include <algorithm>
#include <cmath>

namespace kaz::host {

void RoundTrip::add(Time round_trip) {
  RoundTripStatistics& s = statistics_;
  const double r = seconds(round_trip);
  s.min_s = s.count ? std::min(s.min_s, r) : r;
  s.max_s = std::max(s.max_s, r);
  s.last_s = r;
  if (s.count == 0) {
    s.smoothed_s = r;
    s.variation_s = r / 2;
  } else {
    s.variation_s += (std::abs(s.smoothed_s - r) - s.variation_s) / 4;
    s.smoothed_s += (r - s.smoothed_s) / 8;
  }
  ++s.count;
  s.mean_s += (r - s.mean_s) / static_cast<double>(s.count);
  timeout_ =
      std::clamp(from_seconds(s.smoothed_s + 4 * s.variation_s), bounds_.shortest, bounds_.longest);
}

void RoundTrip::back_off() {
  timeout_ = std::min(2 * timeout_, bounds_.longest);
}

}  // namespace kaz::host
