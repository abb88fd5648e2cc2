// Counters of a link.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "host/link/round_trip.h"

namespace kaz::host {

struct LinkStatistics {
  std::uint64_t requests = 0, replies = 0, refused = 0, bad_frames = 0;
  std::uint64_t timeouts = 0;  // replies that did not come in time
  std::uint64_t retries = 0;   // transmissions after the first, of whatever cause
  std::uint64_t busy = 0;      // requests that the board had no room for
  std::uint64_t ignored =
      0;  // valid frames without a pending request: late, duplicate, another board
  std::uint64_t telemetry = 0;
  std::uint64_t bytes_out = 0, bytes_in = 0;
  RoundTripStatistics round_trip;
};

}  // namespace kaz::host
