// Retransmission timeout and round-trip statistics of a link.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "shared/base/time.hpp"

namespace kaz::host {

// Statistics of the requests that were answered at their first transmission. A round trip starts at the time
// at which the request's first byte could leave, and ends when the reply's last byte was read.
struct RoundTripStatistics {
  std::uint64_t count = 0;
  double min_s = 0, mean_s = 0, max_s = 0, last_s = 0;
  double smoothed_s = 0, variation_s = 0;  // SRTT and RTTVAR of RFC 6298
};

// Computes the retransmission timeout as in RFC 6298 ("Computing TCP's Retransmission Timer"):
//
//   First round trip R:  SRTT = R, RTTVAR = R / 2.
//   Each further R:      RTTVAR = 3/4 RTTVAR + 1/4 |SRTT - R|, SRTT = 7/8 SRTT + 1/8 R.
//   RTO = SRTT + 4 RTTVAR, within [shortest, longest].
//
// Round trips of repeated requests are ignored (Karn's algorithm). The timeout doubles with each retry. After
// a retry, later requests also have the doubled timeout. The timeout is computed again when a request is
// answered at its first transmission (RFC 6298, sections 3 and 5.5 to 5.7).
class RoundTrip {
 public:
  struct Bounds {
    Time initial, shortest, longest;
  };
  explicit RoundTrip(const Bounds& bounds) : bounds_(bounds), timeout_(bounds.initial) {}

  // Updates the timeout with the round trip of a request that was sent once.
  void add(Time round_trip);
  // Doubles the timeout, up to Bounds::longest.
  void back_off();
  // Returns to the initial timeout, for example after a reconnection.
  void start_anew() { timeout_ = bounds_.initial; }
  Time timeout() const { return timeout_; }
  const RoundTripStatistics& statistics() const { return statistics_; }

 private:
  Bounds bounds_;
  Time timeout_;
  RoundTripStatistics statistics_;
};

}  // namespace kaz::host
