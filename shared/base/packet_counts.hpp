// Counters of a packet decoder. Each received byte belongs to a packet or is counted as bad or skipped.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz {

struct PacketCounts {
  std::uint64_t packets = 0;
  std::uint64_t bad_checksums = 0, bad_lengths = 0;
  std::uint64_t abandoned = 0;      // incomplete packets
  std::uint64_t skipped_bytes = 0;  // bytes between packets
  std::uint64_t bad() const { return bad_checksums + bad_lengths + abandoned; }
};

}  // namespace kaz
