// What happened on a link so far, by cause.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::host {

struct LinkStatistics {
  std::uint64_t requests = 0, replies = 0, timeouts = 0, retries = 0, refused = 0, bad_frames = 0;
  std::uint64_t ignored =
      0;  // sound frames that answered nothing asked: late, doubled, of another board
  std::uint64_t bytes_out = 0, bytes_in = 0;
  double round_trip_s = 0;  // smoothed: each new one counts 1/8 (RFC 6298, section 2)
};

}  // namespace kaz::host
