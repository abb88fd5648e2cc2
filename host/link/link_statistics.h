// Counters of a link's requests, replies, frames and bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "host/link/round_trip.h"

namespace kaz::host {

struct LinkStatistics {
  std::uint64_t requests = 0, replies = 0, refused = 0, bad_frames = 0;
  std::uint64_t timeouts = 0;  // replies that did not arrive in time
  std::uint64_t retries = 0;   // transmissions of a request after the first one, for any cause
  std::uint64_t busy = 0;      // requests that the board refused because the board had no room
  // Number of valid frames that answer no pending request: late, duplicate, or from another board.
  std::uint64_t ignored = 0;
  std::uint64_t telemetry = 0;
  std::uint64_t bytes_out = 0, bytes_in = 0;
  RoundTripStatistics round_trip;
};

}  // namespace kaz::host
