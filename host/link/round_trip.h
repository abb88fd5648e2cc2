// Retransmission time-out and round-trip statistics of a link.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "vision/image/frame.h"  // Time

namespace kaz::host {

// Of requests answered at their first transmission: from when the first byte could leave to when the last
// byte of the reply was read.
struct RoundTripStatistics {
  std::uint64_t count = 0;
  double min_s = 0, mean_s = 0, max_s = 0, last_s = 0;
  double smoothed_s = 0, variation_s = 0;  // SRTT and RTTVAR of RFC 6298
};

// The retransmission time-out of V. Paxson et al., "Computing TCP's Retransmission Timer", RFC 6298:
//   first round trip R:  SRTT = R, RTTVAR = R / 2
//   each further one:    RTTVAR = 3/4 RTTVAR + 1/4 |SRTT - R|,  SRTT = 7/8 SRTT + 1/8 R
//   RTO = SRTT + 4 RTTVAR, within [shortest, longest]
// Round trips of repeated requests are not taken (Karn's algorithm), so the time-out doubles with
// each repetition and stays so until a request is answered at once (its sections 3 and 5.5 to 5.7).
class RoundTrip {
 public:
  struct Bounds {
    Time initial, shortest, longest;
  };
  explicit RoundTrip(const Bounds& bounds) : bounds_(bounds), timeout_(bounds.initial) {}

  void add(Time round_trip);
  void back_off();
  // Back to the initial time-out, e.g. after a reconnection.
  void start_anew() { timeout_ = bounds_.initial; }
  Time timeout() const { return timeout_; }
  const RoundTripStatistics& statistics() const { return statistics_; }

 private:
  Bounds bounds_;
  Time timeout_;
  RoundTripStatistics statistics_;
};

}  // namespace kaz::host
